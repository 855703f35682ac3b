/* Platform modes of many designs, several of them in each vector. A "lane" is one design; nothing that happens in a lane depends on the others, so
 * results do not depend on which designs are computed together. Blocks, elimination, which modes are the platform's and derivatives are those of
 * blocks.py, factor.py, subspace.py and slopes.py, where they are explained; the wanted modes are found singly:
 *
 * 1. Z = (K - sigma M)^-1 F for the inertial forces F of the family's own modes, sigma amid their values; Rayleigh-Ritz on Z.
 * 2. For each wanted mode x of these, sigma just below its value and T = (K - sigma M)^-1 M: y = T x, twice. Rayleigh-Ritz on the y alone, with
 *    K y = sigma M y + M x.
 * 3. T's Rayleigh quotient theta at x and the residual |y - theta x| in M bound what y has of modes whose lambda is `outer` or more, for which T is
 *    1 / (outer - sigma) at most: its sine is (sine of the angle between x and y) / ((outer - sigma) theta - 1) at most.
 * 4. As many pivots of K - shift M are negative as values lie below the shift: none is missed.
 *
 * Own blocks of bodies are lower triangles by rows, edges 6x6 by rows; vectors are [body][6][m]; every entry is a vector of WIDTH designs.
 */
#include "lanes.h"

#define MOST 16     /* vectors of a block */
#define MODES 12    /* modes that may be asked for */
#define BESIDE 1e-6 /* how far below its value a single mode's shift is: its matrix is never singular */
#define AHEAD 4     /* vectors of designs whose numbers are gathered at once: rows are far apart, and a page holds few */

typedef double loose __attribute__((vector_size(WIDTH * 8), aligned(8)));

typedef struct {
    /* sizes */
    int64_t designs, numbers_stride, slopes_stride, stride, bodies, links, edges, updates, numbers, m, count, rounds, steps, variables, widest, entries, single, parts;
    /* tables */
    const int64_t *link;    /* links x (part, place of first body, place of second body, edge); -1: the ground, no edge */
    const int64_t *range;   /* bodies + 1: where the edges of each body begin */
    const int64_t *later;   /* edges: the later body */
    const int64_t *heavy;   /* edges: whether some link is on it */
    const int64_t *product; /* bodies + 1: where the updates of each body begin */
    const int64_t *update;  /* updates x (edge, edge, target); -1: the later body's own block */
    const int64_t *mirror;  /* numbers: the one that is the same by symmetry, or itself */
    const int64_t *inertia; /* bodies: where the inertia of the body at that place begins among the numbers */
    const int64_t *start;   /* stiffness, mass, turn, first, second */
    const int64_t *slot;    /* slots x (kind, owner or place, row, column) */
    const int64_t *reach;   /* groups + 1: where the slots of each group begin: parts (laws), links (places), bodies by place (inertia) */
    const int64_t *about;   /* groups + 1: where their entries begin */
    const int64_t *entry;   /* entries x (variable, slot, row of `changes`), by group, then by variable */
    const int64_t *alike;   /* links, those of one part together */
    const int64_t *plane;   /* bodies x (link, axis): whose axes the body has, the axis normal to the plane of symmetry; -1: the stage's */
    const int64_t *normal;  /* links: the axis of each that is normal to its leg's plane; -1: it is not symmetric about it */
    const int64_t *flat;    /* bodies x 2: whether own blocks of K and M are split, and as elimination leaves them */
    const int64_t *thin;    /* edges x 2: so for edges */
    const double *force;    /* bodies x 6 x m: inertial forces of the modes to begin with */
    const double *numbers_; /* numbers x numbers_stride */
    const double *changes;  /* entries x slopes_stride */
    /* settings */
    double shift, value, angle, limit, cluster, together, shares, margin, pivot, skew, span;
    /* results */
    double *values, *share; /* count x stride, whole vectors of designs */
    int64_t *good;          /* designs: 1, 0 for what is not proved, -1 where legs have not these planes */
    double *slopes;         /* pairs (i, i), then (i, j > i), x variables x stride, zero */
} Task;

#define INLINE inline __attribute__((always_inline))
#if defined(__clang__)
#define UNROLL /* does so by itself, and worse where told to */
#else
#define UNROLL _Pragma("GCC unroll 36") /* small fixed loops: what they work on stays in registers */
#endif

/* ---- lanes ---- */

static inline lanes root(lanes a) { for (int i = 0; i < WIDTH; i++) a[i] = sqrt(a[i]); return a; }
static inline lanes load(const double *p) { return *(const loose *)p; }
/* A row's designs from one on; the last one stands for those that are not there. */
static inline lanes load_at(const double *p, int64_t design, int64_t designs)
{
    if (design + WIDTH <= designs) return load(p + design);
    lanes r;
    for (int i = 0; i < WIDTH; i++) r[i] = p[design + i < designs ? design + i : designs - 1];
    return r;
}
static inline void store(double *p, lanes a) { *(loose *)p = a; }

/* ---- 6x6 blocks ---- */

#define OWN 21
#define LOWER(i, k) ((i) * ((i) + 1) / 2 + (k)) /* k <= i */

/* Bodies that are symmetric about a plane have axes of their own: entries are x, y, rz, z, rx, ry there, and those of either half have nothing
 * in common with the others. */
#define BOTH(split, i, k) (!(split) || (i) / 3 == (k) / 3)

enum { PLAIN, TURNED, SYMMETRIC };

static INLINE lanes entry(const lanes *a, int r, int c, const int kind)
{
    return a[kind == SYMMETRIC ? r >= c ? LOWER(r, c) : LOWER(c, r) : kind == TURNED ? 6 * c + r : 6 * r + c];
}

/* n columns x (6, n), side by side, from v (6, m). */
static INLINE void pick_columns(lanes *x, const lanes *v, int m, const int n)
{
    UNROLL for (int c = 0; c < 6; c++)
        UNROLL for (int k = 0; k < n; k++) x[c * n + k] = v[c * m + k];
}

#define SIZE 6
#define SIZED(name) name##_whole
#include "blocks.h"
#undef SIZE
#undef SIZED
#define SIZE 3
#define SIZED(name) name##_split
#include "blocks.h"

/* `what` with four columns from j on at once, then with what is left of m. */
#define IN_COLUMNS(m, what)                                            \
    {                                                                  \
        int j = 0;                                                     \
        for (; j + 4 <= (m); j += 4) { enum { n = 4 }; what; }         \
        if ((m) - j == 3) { enum { n = 3 }; what; }                    \
        else if ((m) - j == 2) { enum { n = 2 }; what; }               \
        else if ((m) - j == 1) { enum { n = 1 }; what; }               \
    }

/* ---- assembly ---- */

/* out (6x6) = 3x3 blocks of `from`, `stride` wide, turned into the stage's axes: R block R^T; of what is symmetric the upper half follows. */
static INLINE void turn(lanes *out, const lanes *from, const int stride, const lanes *r, const int *zero, const int symmetric)
{
    for (int p = 0; p < 2; p++)
        for (int q = 0; q < (symmetric ? p + 1 : 2); q++) {
            lanes *o = out + 18 * p + 3 * q;
            const lanes *f = from + 3 * stride * p + 3 * q;
            lanes half[9];
            const int none = zero[(stride == 12 ? 4 : 2) * p + q];
            UNROLL for (int i = 0; i < 9 && !none; i++)
                half[i] = r[i - i % 3] * f[i % 3] + r[i - i % 3 + 1] * f[stride + i % 3] + r[i - i % 3 + 2] * f[2 * stride + i % 3];
            UNROLL for (int i = 0; i < 3; i++)
                UNROLL for (int k = 0; k < 3; k++)
                    if (none) o[6 * i + k] = all(0.0);
                    else if (!symmetric || p > q || k <= i) o[6 * i + k] = half[3 * i] * r[3 * k] + half[3 * i + 1] * r[3 * k + 1] + half[3 * i + 2] * r[3 * k + 2];
        }
    if (symmetric)
        UNROLL for (int i = 0; i < 6; i++)
            UNROLL for (int k = i + 1; k < 6; k++) out[6 * i + k] = out[6 * k + i];
}

/* p = n T(b), T = [1, [arm]x; 0, 1]. */
static INLINE void carried(lanes *p, const lanes *n, const lanes *b)
{
    for (int i = 0; i < 6; i++) {
        const lanes *v = n + 6 * i;
        p[6 * i] = v[0], p[6 * i + 1] = v[1], p[6 * i + 2] = v[2];
        p[6 * i + 3] = v[3] + (v[1] * b[2] - v[2] * b[1]);
        p[6 * i + 4] = v[4] + (v[2] * b[0] - v[0] * b[2]);
        p[6 * i + 5] = v[5] + (v[0] * b[1] - v[1] * b[0]);
    }
}

/* out += sign T(a)^T p, out of a kind. */
static INLINE void join(lanes *out, const lanes *p, const lanes *a, double sign, const int kind, const int *row, const int *column)
{
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < (kind == SYMMETRIC ? i + 1 : 6); k++) {
            lanes x = p[6 * i + k];
            if (i > 2) x += p[6 * ((i + 1) % 3) + k] * a[(i + 2) % 3] - p[6 * ((i + 2) % 3) + k] * a[(i + 1) % 3];
            const int r = row[i], c = column[k];
            out[kind == SYMMETRIC ? r > c ? LOWER(r, c) : LOWER(c, r) : kind == TURNED ? 6 * c + r : 6 * r + c] += sign * x;
        }
}

/* What of a part's law and mass is not zero in every design: 3x3 blocks (4 and 16) that are; columns by row (6 and 12). */
typedef struct { int zero[20], start[19], column[180]; } Law;

typedef struct {
    Law *law;
    int64_t *crossing, crossings;    /* entries of laws that are zero where the plane is one of symmetry, and are not in every design */
    int fills;                       /* whether elimination makes edges */
    lanes *number, *change;          /* the numbers of these designs, and their derivatives */
    lanes *numbers, *changes;        /* those of AHEAD vectors of designs */
    lanes *stiff, *stiff_edge;       /* K */
    lanes *mass, *mass_edge;         /* M */
    lanes *other, *other_edge;       /* K - shift M factored */
    lanes *now, *next, *force, *ahead; /* blocks of vectors */
    lanes *shapes;                   /* modes found (6 bodies, count) */
    lanes *sum, *slope;              /* slots of a group x pairs, variables x pairs */
} Room;

/* ---- assembly in axes of a plane ---- */

/* Whether an edge of a body with axes of its own leads to another with the same ones: to every one but the platform. */
static INLINE int inner(const Task *t, int64_t e) { return t->later[e] < t->bodies - 1; }

static const int SPOT[6] = {0, 1, 5, 2, 3, 4}; /* x, y, rz, z, rx, ry among x, y, z, rx, ry, rz */

/* The axes q (columns) of a body with axes of its own: those of a link, the normal last. */
static INLINE void axes_of(lanes *q, const Task *t, const Room *w, int64_t body)
{
    const lanes *r = w->number + t->start[2] + 9 * t->plane[2 * body];
    const int normal = (int)t->plane[2 * body + 1];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) q[3 * i + k] = r[3 * i + (normal + 1 + k) % 3];
}

/* A link's axes in those of its leg: the two in the plane (2x2) and the normal; arms in the leg's axes. */
typedef struct { lanes p[4], s, arm[2][2]; int spot[6]; } Side;

static INLINE lanes along(const lanes *q, int i, const lanes *v, int step) { return q[i] * v[0] + q[3 + i] * v[step] + q[6 + i] * v[2 * step]; }

/* Says in which lanes the link is not of that plane. */
static INLINE marks lay(const Task *t, const Room *w, int64_t l, const lanes *q, Side *out)
{
    const lanes *r = w->number + t->start[2] + 9 * l;
    const int normal = (int)t->normal[l], one = (normal + 1) % 3, two = (normal + 2) % 3;
    const int spot[6] = {one, two, 3 + normal, normal, 3 + one, 3 + two};
    memcpy(out->spot, spot, sizeof spot);
    out->p[0] = along(q, 0, r + one, 3), out->p[1] = along(q, 0, r + two, 3);
    out->p[2] = along(q, 1, r + one, 3), out->p[3] = along(q, 1, r + two, 3);
    out->s = along(q, 2, r + normal, 3);
    marks bad = ~(size_of(along(q, 2, r + one, 3)) + size_of(along(q, 2, r + two, 3)) <= t->skew);
    for (int side = 0; side < 2; side++) {
        const int64_t body = t->link[4 * l + 1 + side];
        if (body < 0 || t->plane[2 * body] < 0) continue;
        const lanes *arm = w->number + t->start[3 + side] + 3 * l;
        out->arm[side][0] = along(q, 0, arm, 1), out->arm[side][1] = along(q, 1, arm, 1);
        bad |= ~(size_of(along(q, 2, arm, 1)) <= t->skew * t->span);
    }
    return bad;
}

/* out (6x6, split) = a law's block, `stride` wide, in the axes of the leg. */
static INLINE void lie(lanes *out, const lanes *from, const int stride, const Side *at, const int turned)
{
    const lanes *p = at->p;
#define OF(i, k) (turned ? from[stride * at->spot[k] + at->spot[i]] : from[stride * at->spot[i] + at->spot[k]])
    UNROLL for (int half = 0; half < 2; half++) {
        const int u = 4 * half, n = 2 + half; /* two in the plane, the other one */
        lanes g[4], h[2];
        UNROLL for (int i = 0; i < 2; i++) {
            UNROLL for (int k = 0; k < 2; k++) g[2 * i + k] = p[2 * i] * OF(u, u + k) + p[2 * i + 1] * OF(u + 1, u + k);
            h[i] = p[2 * i] * OF(u, n) + p[2 * i + 1] * OF(u + 1, n);
        }
        UNROLL for (int i = 0; i < 2; i++) {
            UNROLL for (int k = 0; k < 2; k++) out[6 * (u + i) + u + k] = g[2 * i] * p[2 * k] + g[2 * i + 1] * p[2 * k + 1];
            out[6 * (u + i) + n] = at->s * h[i];
            out[6 * n + u + i] = at->s * (p[2 * i] * OF(n, u) + p[2 * i + 1] * OF(n, u + 1));
        }
        out[7 * n] = at->s * at->s * OF(n, n);
    }
#undef OF
}

/* p = n T(b) and out += sign T(a)^T p as `carried` and `join`, in the plane. */
static INLINE void carried_plane(lanes *p, const lanes *n, const lanes *b)
{
    UNROLL for (int i = 0; i < 36; i++)
        if (BOTH(1, i / 6, i % 6)) p[i] = n[i];
    UNROLL for (int i = 0; i < 18; i += 6) {
        p[i + 2] += n[i] * b[1] - n[i + 1] * b[0];
        p[i + 22] -= n[i + 21] * b[1];
        p[i + 23] += n[i + 21] * b[0];
    }
}

static INLINE void join_plane(lanes *out, const lanes *p, const lanes *a, double sign, const int kind, const int narrow)
{
    UNROLL for (int i = 0; i < 6; i++)
        UNROLL for (int k = 0; k < 6; k++) {
            if (!BOTH(narrow, i, k) || (kind == SYMMETRIC && k > i)) continue;
            lanes x = p[6 * i + k];
            if (i == 2) x += p[k] * a[1] - p[6 + k] * a[0];
            if (i == 4) x -= p[18 + k] * a[1];
            if (i == 5) x += p[18 + k] * a[0];
            out[kind == SYMMETRIC ? LOWER(i, k) : 6 * i + k] += sign * x;
        }
}

/* Columns of n (6x6, split) in the stage's axes. */
static INLINE void open_columns(lanes *p, const lanes *n, const lanes *q)
{
    UNROLL for (int i = 0; i < 3; i++)
        UNROLL for (int k = 0; k < 3; k++) {
            p[6 * i + k] = n[6 * i] * q[3 * k] + n[6 * i + 1] * q[3 * k + 1];
            p[6 * i + 3 + k] = n[6 * i + 2] * q[3 * k + 2];
            p[18 + 6 * i + k] = n[18 + 6 * i + 3] * q[3 * k + 2];
            p[21 + 6 * i + k] = n[18 + 6 * i + 4] * q[3 * k] + n[18 + 6 * i + 5] * q[3 * k + 1];
        }
}

/* What is turned from a link's axes (r) into those of its body, in which its arms are, goes to places by row and by column. */
static const int ORDER[6] = {0, 1, 2, 3, 4, 5}, PLACE[6] = {0, 1, 3, 4, 5, 2}; /* x, y, z, rx, ry, rz among x, y, rz, z, rx, ry */

/* One of a link's own blocks. */
static INLINE void add_own(lanes *own, const lanes *law, const int stride, const lanes *r, const int *zero, const lanes *arm, const int *place)
{
    lanes n[36], p[36];
    turn(n, law, stride, r, zero, 1), carried(p, n, arm), join(own, p, arm, 1.0, SYMMETRIC, place, place);
}

/* A link's edge of K or M (`symmetric`: K); columns are in the stage's axes where those of the row's body are q. */
static INLINE void add_edge(
    lanes *edge, const lanes *law, const int stride, const lanes *r, const int *zero, const lanes *first, const lanes *second, double sign,
    const int symmetric, const lanes *q, const int *row, const int *column)
{
    lanes n[36], p[36];
    turn(n, law, stride, r, zero, symmetric);
    if (q)
        for (int i = 0; i < 36; i += 3) {
            lanes u[3];
            for (int k = 0; k < 3; k++) u[k] = n[i] * q[3 * k] + n[i + 1] * q[3 * k + 1] + n[i + 2] * q[3 * k + 2];
            memcpy(n + i, u, sizeof u);
        }
    carried(p, n, second), join(edge, p, first, sign, PLAIN, row, column);
}

/* Adds a link that is not symmetric about a plane; of bodies with axes of their own in these. */
static void assemble_whole(const Task *t, Room *w, int64_t l)
{
    const int64_t part = t->link[4 * l], *body = t->link + 4 * l + 1, e = t->link[4 * l + 3];
    const lanes *k = w->number + t->start[0] + 36 * part, *m = w->number + t->start[1] + 144 * part, *r = w->number + t->start[2] + 9 * l;
    const lanes *arm[2] = {w->number + t->start[3] + 3 * l, w->number + t->start[4] + 3 * l};
    const int *zero = w->law[part].zero;
    lanes q[9], own_r[9], own_arm[2][3], crossed[36];
    const int64_t leg = body[body[0] < 0 || t->plane[2 * body[0]] < 0];
    const int has = leg >= 0 && t->plane[2 * leg] >= 0;
    if (has) {
        axes_of(q, t, w, leg);
        for (int i = 0; i < 9; i++) own_r[i] = along(q, i / 3, r + i % 3, 3);
        for (int i = 0; i < 6; i++) own_arm[i / 3][i % 3] = along(q, i % 3, arm[i / 3], 1);
    }
    for (int side = 0; side < 2; side++) {
        if (body[side] < 0) continue;
        const int own = t->plane[2 * body[side]] >= 0;
        const lanes *turns = own ? own_r : r, *reach = own ? own_arm[side] : arm[side];
        const int *place = own ? PLACE : ORDER;
        add_own(w->stiff + OWN * body[side], k, 6, turns, zero, reach, place);
        add_own(w->mass + OWN * body[side], m + 78 * side, 12, turns, zero + 4 + 10 * side, reach, place);
    }
    if (e < 0) return;
    const int one = body[0] > body[1], two = 1 - one, same = has && inner(t, e);
    int none[4];
    for (int i = 0; i < 36; i++) crossed[i] = one ? m[72 + 12 * (i / 6) + i % 6] : m[6 + 12 * (i / 6) + i % 6];
    for (int i = 0; i < 4; i++) none[i] = one ? zero[4 + 8 + 4 * (i / 2) + i % 2] : zero[4 + 2 + 4 * (i / 2) + i % 2];
    const lanes *turns = has ? own_r : r, *first = has ? own_arm[one] : arm[one], *second = same ? own_arm[two] : arm[two], *open = has && !same ? q : 0;
    const int *row = has ? PLACE : ORDER, *column = same ? PLACE : ORDER;
    add_edge(w->stiff_edge + 36 * e, k, 6, turns, zero, first, second, -1.0, 1, open, row, column);
    add_edge(w->mass_edge + 36 * e, crossed, 6, turns, none, first, second, 1.0, 0, open, row, column);
}

/* Adds a link of a leg with axes of its own; tells in which lanes it is not of the leg's plane. */
static marks assemble_plane(const Task *t, Room *w, int64_t l)
{
    const int64_t part = t->link[4 * l], *body = t->link + 4 * l + 1, e = t->link[4 * l + 3];
    const lanes *k = w->number + t->start[0] + 36 * part, *m = w->number + t->start[1] + 144 * part;
    const lanes *r = w->number + t->start[2] + 9 * l;
    const int *zero = w->law[part].zero;
    lanes q[9], n[36], p[36], stiff[36];
    Side at;
    axes_of(q, t, w, body[body[0] < 0 || t->plane[2 * body[0]] < 0]);
    const marks bad = lay(t, w, l, q, &at);
    lie(stiff, k, 6, &at, 0);
    for (int side = 0; side < 2; side++) {
        if (body[side] < 0) continue;
        lanes *own = w->stiff + OWN * body[side], *heavy = w->mass + OWN * body[side];
        if (t->plane[2 * body[side]] >= 0) {
            carried_plane(p, stiff, at.arm[side]), join_plane(own, p, at.arm[side], 1.0, SYMMETRIC, 1);
            lie(n, m + 78 * side, 12, &at, 0), carried_plane(p, n, at.arm[side]), join_plane(heavy, p, at.arm[side], 1.0, SYMMETRIC, 1);
        } else {
            const lanes *arm = w->number + t->start[3 + side] + 3 * l;
            turn(n, k, 6, r, zero, 1), carried(p, n, arm), join(own, p, arm, 1.0, SYMMETRIC, ORDER, ORDER);
            turn(n, m + 78 * side, 12, r, zero + 4 + 10 * side, 1), carried(p, n, arm), join(heavy, p, arm, 1.0, SYMMETRIC, ORDER, ORDER);
        }
    }
    if (e < 0) return bad;
    const int row = body[0] > body[1];
    if (row) lie(n, m + 6, 12, &at, 1);
    else lie(n, m + 6, 12, &at, 0);
    if (inner(t, e)) {
        carried_plane(p, stiff, at.arm[!row]), join_plane(w->stiff_edge + 36 * e, p, at.arm[row], -1.0, PLAIN, 1);
        carried_plane(p, n, at.arm[!row]), join_plane(w->mass_edge + 36 * e, p, at.arm[row], 1.0, PLAIN, 1);
    } else {
        const lanes *arm = w->number + t->start[4 - row] + 3 * l;
        lanes wide[36];
        open_columns(wide, stiff, q), carried(p, wide, arm), join_plane(w->stiff_edge + 36 * e, p, at.arm[row], -1.0, PLAIN, 0);
        open_columns(wide, n, q), carried(p, wide, arm), join_plane(w->mass_edge + 36 * e, p, at.arm[row], 1.0, PLAIN, 0);
    }
    return bad;
}

/* A body's inertia in axes of its own; tells in which lanes it is not symmetric about the plane. */
static marks weigh_plane(const Task *t, Room *w, int64_t b)
{
    static const int none[4];
    lanes q[9], r[9], own[36];
    marks bad = {0};
    axes_of(q, t, w, b);
    for (int i = 0; i < 9; i++) r[i] = q[3 * (i % 3) + i / 3];
    turn(own, w->number + t->inertia[b], 6, r, none, 1);
    for (int i = 0; i < 6; i++)
        for (int k = 0; k <= i; k++) {
            const lanes x = own[6 * SPOT[i] + SPOT[k]];
            const int kept = BOTH(1, i, k) || !t->flat[2 * b];
            w->mass[OWN * b + LOWER(i, k)] = kept ? x : all(0.0);
            if (!kept) bad |= ~(x * x <= t->skew * t->skew * (own[7 * SPOT[i]] * own[7 * SPOT[k]]));
        }
    return bad;
}

static marks assemble(const Task *t, Room *w)
{
    marks bad = {0};
    memset(w->stiff, 0, sizeof(lanes) * OWN * t->bodies);
    memset(w->stiff_edge, 0, sizeof(lanes) * 36 * t->edges);
    memset(w->mass_edge, 0, sizeof(lanes) * 36 * t->edges);
    for (int64_t i = 0; i < w->crossings; i++) bad |= ~(w->number[w->crossing[i]] == 0.0);
    for (int64_t b = 0; b < t->bodies; b++)
        if (t->plane[2 * b] >= 0) bad |= weigh_plane(t, w, b);
        else for (int i = 0; i < 6; i++) memcpy(w->mass + OWN * b + LOWER(i, 0), w->number + t->inertia[b] + 6 * i, sizeof(lanes) * (i + 1));
    for (int64_t l = 0; l < t->links; l++)
        if (t->normal[l] >= 0) bad |= assemble_plane(t, w, l);
        else assemble_whole(t, w, l);
    return bad;
}

/* ---- elimination ---- */

/* A product of two edges of body v, which elimination subtracts from what is between later bodies. */
static INLINE void join_update(const Task *t, Room *w, int64_t v, const int64_t *edges)
{
    const lanes *own = w->other + OWN * v, *x = w->other_edge + 36 * edges[0], *y = w->other_edge + 36 * edges[1];
    lanes *to = w->other_edge + 36 * edges[2];
    const int left = (int)t->thin[2 * edges[0] + 1], right = (int)t->thin[2 * edges[1] + 1];
    for (int c = 0; c < 6; c++) {
        lanes scaled[6];
        UNROLL for (int i = 0; i < 6; i++) scaled[i] = own[LOWER(i, i)] * y[6 * i + c];
        if (right)
            UNROLL for (int i = 0; i < 3; i++) scaled[c < 3 ? 3 + i : i] = all(0.0);
        if (left) multiply_split(to + c, x, scaled, 6, TURNED, 1, 1);
        else multiply_whole(to + c, x, scaled, 6, TURNED, 1, 1);
    }
}

/* w->other, w->other_edge = K - shift M = L D L^T: own blocks as `invert` leaves them, edges L^-1 times themselves. Gives per lane how many
 * pivots are negative and the least pivot over its own entry of K, where these are asked for. */
static INLINE void eliminate(const Task *t, Room *w, lanes shift, const int told, lanes *negative, lanes *least)
{
    for (int64_t v = 0; v < t->bodies; v++) {
        lanes *own = w->other + OWN * v;
        const lanes *stiff = w->stiff + OWN * v, *mass = w->mass + OWN * v;
        if (t->flat[2 * v + 1]) shifted_split(own, stiff, mass, shift);
        else shifted_whole(own, stiff, mass, shift);
    }
    if (w->fills)
        for (int64_t i = 0; i < 36 * t->edges; i++) w->other_edge[i] = w->stiff_edge[i] - shift * w->mass_edge[i];
    for (int64_t v = 0; v < t->bodies; v++) {
        lanes pivot[6], *own = w->other + OWN * v;
        const int split = (int)t->flat[2 * v + 1];
        if (split) invert_split(own, pivot);
        else invert_whole(own, pivot);
        UNROLL for (int s = 0; told && s < 6; s++) {
            const lanes ratio = size_of(pivot[s]) / w->stiff[OWN * v + LOWER(s, s)];
            *negative += pick(pivot[s] < 0.0, all(1.0), all(0.0));
            *least = pick(ratio >= *least, *least, ratio);
        }
        for (int64_t e = t->range[v]; e < t->range[v + 1]; e++) {
            lanes *edge = w->other_edge + 36 * e;
            const lanes *stiff = w->stiff_edge + 36 * e, *mass = w->mass_edge + 36 * e;
            if (t->thin[2 * e + 1]) reduce_split(edge, stiff, mass, shift, own, w->fills, 1);
            else if (split) reduce_split(edge, stiff, mass, shift, own, w->fills, 0);
            else reduce_whole(edge, stiff, mass, shift, own, w->fills, 0);
        }
        for (int64_t u = t->product[v]; u < t->product[v + 1]; u++) {
            const int64_t left = t->update[3 * u];
            lanes *later = w->other + OWN * t->later[left];
            const lanes *x = w->other_edge + 36 * left;
            if (t->update[3 * u + 2] >= 0) join_update(t, w, v, t->update + 3 * u);
            else if (t->thin[2 * left + 1]) update_split(later, x, own, 3), update_split(later, x, own, 0);
            else update_whole(later, x, own, 3), update_whole(later, x, own, 0);
        }
    }
}

/* y += or -= a x for n columns, a split or whole. */
static INLINE void apply(lanes *y, const lanes *a, const lanes *x, int m, const int kind, const int negative, const int n, int64_t split)
{
    if (split) multiply_split(y, a, x, m, kind, negative, n);
    else multiply_whole(y, a, x, m, kind, negative, n);
}

static INLINE void forward(const Task *t, const Room *w, lanes *restrict x, int64_t v, int m, const int n)
{
    const lanes *a = w->other + OWN * v;
    lanes u[24];
    pick_columns(u, x + 6 * m * v, m, n);
    if (t->flat[2 * v + 1]) lower_split(u, a, n);
    else lower_whole(u, a, n);
    UNROLL for (int i = 0; i < 6; i++)
        UNROLL for (int k = 0; k < n; k++) x[6 * m * v + i * m + k] = u[i * n + k] *= a[LOWER(i, i)];
    for (int64_t e = t->range[v]; e < t->range[v + 1]; e++) apply(x + 6 * m * t->later[e], w->other_edge + 36 * e, u, m, TURNED, 1, n, t->thin[2 * e + 1]);
}

static INLINE void backward(const Task *t, const Room *w, lanes *restrict x, int64_t v, int m, const int n)
{
    const lanes *a = w->other + OWN * v;
    lanes u[24];
    for (int64_t e = t->range[v]; e < t->range[v + 1]; e++) {
        /* D^-1 has been applied: here to what the edge adds, too. */
        lanes sum[24];
        pick_columns(u, x + 6 * m * t->later[e], m, n);
        UNROLL for (int i = 0; i < 6 * n; i++) sum[i] = all(0.0);
        apply(sum, w->other_edge + 36 * e, u, n, PLAIN, 0, n, t->thin[2 * e + 1]);
        UNROLL for (int i = 0; i < 6; i++)
            UNROLL for (int k = 0; k < n; k++) x[6 * m * v + i * m + k] -= a[LOWER(i, i)] * sum[i * n + k];
    }
    pick_columns(u, x + 6 * m * v, m, n);
    if (t->flat[2 * v + 1]) upper_split(u, a, n);
    else upper_whole(u, a, n);
    UNROLL for (int i = 0; i < 6; i++)
        UNROLL for (int k = 0; k < n; k++) x[6 * m * v + i * m + k] = u[i * n + k];
}

/* What body v and its edges to later bodies add to n columns of y = M x. */
static INLINE void weigh(const Task *t, const Room *w, lanes *restrict y, const lanes *restrict x, int64_t v, int m, const int n)
{
    lanes u[24], other[24];
    pick_columns(u, x + 6 * m * v, m, n);
    apply(y + 6 * m * v, w->mass + OWN * v, u, m, SYMMETRIC, 0, n, t->flat[2 * v]);
    for (int64_t e = t->range[v]; e < t->range[v + 1]; e++)
        if (t->heavy[e]) {
            pick_columns(other, x + 6 * m * t->later[e], m, n);
            apply(y + 6 * m * t->later[e], w->mass_edge + 36 * e, u, m, TURNED, 0, n, t->thin[2 * e]);
            apply(y + 6 * m * v, w->mass_edge + 36 * e, other, m, PLAIN, 0, n, t->thin[2 * e]);
        }
}

/* x = (K - shift M)^-1 x, m vectors, by what `eliminate` left, and y = M x. */
static INLINE void solve(const Task *t, const Room *w, lanes *restrict x, lanes *restrict y, const int m)
{
    for (int64_t v = 0; v < t->bodies; v++) IN_COLUMNS(m, forward(t, w, x + j, v, m, n))
    memset(y, 0, sizeof(lanes) * 6 * m * t->bodies);
    for (int64_t v = t->bodies - 1; v >= 0; v--) IN_COLUMNS(m, (backward(t, w, x + j, v, m, n), weigh(t, w, y + j, x + j, v, m, n)))
}

/* ---- Rayleigh-Ritz ---- */

/* Entry (r, i) of m vectors: they stand side by side (row m, column 1) or one after the other (row 1, column n). */
typedef struct { int64_t row, column; } Layout;

static INLINE void dots(int64_t n, int m, Layout at, lanes *g, const lanes *x, const lanes *y, int i0, int j0, const int ni, const int nj)
{
    lanes s[9];
    for (int k = 0; k < 9; k++) s[k] = all(0.0);
    for (int64_t r = 0; r < n; r++)
        for (int i = 0; i < ni; i++)
            for (int j = 0; j < nj; j++) s[3 * i + j] += x[r * at.row + (i0 + i) * at.column] * y[r * at.row + (j0 + j) * at.column];
    for (int i = 0; i < ni; i++)
        for (int j = 0; j < nj; j++) g[(i0 + i) * m + j0 + j] = g[(j0 + j) * m + i0 + i] = s[3 * i + j];
}

/* g (m x m, lower triangle and its mirror) = x^T y, known to be symmetric. */
static void gram(int64_t n, int m, Layout at, lanes *g, const lanes *restrict x, const lanes *restrict y)
{
    for (int i = 0; i < m; i += 3)
        for (int j = 0; j <= i; j += 3) {
            const int rows = m - i;
            if (rows > 2) dots(n, m, at, g, x, y, i, j, 3, 3);
            else if (rows == 2) j < i ? dots(n, m, at, g, x, y, i, j, 2, 3) : dots(n, m, at, g, x, y, i, j, 2, 2);
            else j < i ? dots(n, m, at, g, x, y, i, j, 1, 3) : dots(n, m, at, g, x, y, i, j, 1, 1);
        }
}

static INLINE void blends(int64_t n, int m, Layout at, lanes *y, const lanes *x, const lanes *q, int c, const int ni)
{
    for (int64_t r = 0; r < n; r += 2) { /* n is even */
        lanes s[6];
        for (int k = 0; k < 6; k++) s[k] = all(0.0);
        for (int k = 0; k < m; k++)
            for (int i = 0; i < ni; i++) {
                s[i] += x[r * at.row + k * at.column] * q[k * m + c + i];
                s[3 + i] += x[(r + 1) * at.row + k * at.column] * q[k * m + c + i];
            }
        for (int i = 0; i < ni; i++) y[(c + i) * n + r] = s[i], y[(c + i) * n + r + 1] = s[3 + i];
    }
}

/* y = x q, the first `count` columns of it, one after the other. */
static void blend(int64_t n, int m, Layout at, lanes *restrict y, const lanes *restrict x, const lanes *restrict q, int count)
{
    int c = 0;
    for (; c + 3 <= count; c += 3) blends(n, m, at, y, x, q, c, 3);
    if (count - c == 2) blends(n, m, at, y, x, q, c, 2);
    else if (count - c == 1) blends(n, m, at, y, x, q, c, 1);
}

/* Eigenvalues on the diagonal of a and vectors in v (columns), by Jacobi's rotations; those of a lane stop when they are done. */
static void jacobi(int m, lanes *a, lanes *v, double least)
{
    for (int i = 0; i < m * m; i++) v[i] = all(i % (m + 1) ? 0.0 : 1.0);
    for (int sweep = 0; sweep < 20; sweep++) {
        int moved = 0;
        for (int p = 0; p < m - 1; p++)
            for (int q = p + 1; q < m; q++) {
                const lanes o = a[p * m + q], d = a[p * m + p], e = a[q * m + q];
                const marks turn = size_of(o) > least * root(size_of(d * e));
                if (!any(turn)) continue;
                moved = 1;
                const lanes half = (e - d) / pick(turn, o + o, all(1.0)), square = root(half * half + 1.0);
                lanes t = 1.0 / (size_of(half) + square);
                t = pick(half < 0.0, -t, t);
                t = pick(turn, t, all(0.0));
                const lanes c = 1.0 / root(t * t + 1.0), s = t * c;
                a[p * m + p] = d - t * o, a[q * m + q] = e + t * o;
                a[p * m + q] = a[q * m + p] = pick(turn, all(0.0), o);
                for (int k = 0; k < m; k++) {
                    const lanes x = v[k * m + p], y = v[k * m + q];
                    v[k * m + p] = c * x - s * y, v[k * m + q] = s * x + c * y;
                    if (k == p || k == q) continue;
                    const lanes f = a[k * m + p], g = a[k * m + q];
                    a[k * m + p] = a[p * m + k] = c * f - s * g;
                    a[k * m + q] = a[q * m + k] = s * f + c * g;
                }
            }
        if (!moved) break;
    }
}

/* Ascending lambda (m) of stiff q = lambda mass q, q^T mass q = 1, in the columns of q; to `least`, relative. */
static void small(int m, lanes *stiff, lanes *mass, lanes *values, lanes *q, double least)
{
    lanes scale[MOST], turned[MOST * MOST];
    for (int i = 0; i < m; i++) scale[i] = 1.0 / root(mass[i * m + i]);
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++) stiff[i * m + j] *= scale[i] * scale[j], mass[i * m + j] *= scale[i] * scale[j];
    for (int j = 0; j < m; j++) { /* Cholesky, lower, the diagonal inverted */
        for (int k = 0; k < j; k++) mass[j * m + j] -= mass[j * m + k] * mass[j * m + k];
        const lanes inverse = mass[j * m + j] = 1.0 / root(mass[j * m + j]);
        for (int i = j + 1; i < m; i++) {
            for (int k = 0; k < j; k++) mass[i * m + j] -= mass[i * m + k] * mass[j * m + k];
            mass[i * m + j] *= inverse;
        }
    }
    for (int pass = 0; pass < 2; pass++) { /* L^-1 stiff L^-T: its upper triangle first, then its lower one */
        for (int c = 0; c < m; c++)
            for (int i = 0; i < m; i++) {
                lanes s = stiff[i * m + c];
                for (int k = 0; k < i; k++) s -= mass[i * m + k] * stiff[k * m + c];
                stiff[i * m + c] = s * mass[i * m + i];
            }
        for (int i = 0; i < m; i++)
            for (int j = 0; j < m; j++) turned[j * m + i] = stiff[i * m + j];
        memcpy(stiff, turned, sizeof(lanes) * m * m);
    }
    for (int i = 0; i < m; i++)
        for (int j = 0; j < i; j++) stiff[i * m + j] = stiff[j * m + i] = 0.5 * (stiff[i * m + j] + stiff[j * m + i]);
    jacobi(m, stiff, turned, least);
    for (int c = 0; c < m; c++)
        for (int i = m - 1; i >= 0; i--) {
            lanes s = turned[i * m + c];
            for (int k = i + 1; k < m; k++) s -= mass[k * m + i] * turned[k * m + c];
            turned[i * m + c] = s * mass[i * m + i];
        }
    for (int lane = 0; lane < WIDTH; lane++) {
        int order[MOST];
        for (int i = 0; i < m; i++) {
            int place = i;
            for (; place > 0 && stiff[order[place - 1] * (m + 1)][lane] > stiff[i * (m + 1)][lane]; place--) order[place] = order[place - 1];
            order[place] = i;
        }
        for (int c = 0; c < m; c++) {
            values[c][lane] = stiff[order[c] * (m + 1)][lane];
            for (int i = 0; i < m; i++) q[i * m + c][lane] = scale[i][lane] * turned[i * m + order[c]][lane];
        }
    }
}

/* Of single modes: the shift of each, the Rayleigh quotient of (K - shift M)^-1 M, the sine of the angle between a vector and what that makes of it,
 * and how much of each is in each of the modes. */
typedef struct { lanes values[MOST], share[MOST], shift[MOST], quotient[MOST], sine[MOST], part[MOST * MOST], mix[MOST * MOST]; } Ritz;

/* The share of the platform in mode c of x q, x the platform's rows. */
static lanes share_of(const Task *t, const Room *w, const lanes *x, const lanes *q, int m, int c)
{
    const lanes *platform = w->number + t->inertia[t->bodies - 1];
    lanes seen[6], sum = all(0.0);
    for (int i = 0; i < 6; i++) {
        seen[i] = x[i * m] * q[c];
        for (int k = 1; k < m; k++) seen[i] += x[i * m + k] * q[k * m + c];
    }
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < 6; k++) sum += seen[i] * platform[6 * i + k] * seen[k];
    return sum;
}

/* Rayleigh-Ritz on (K - shift M)^-1 times the forces to begin with: all values, and M times the modes that are wanted, in w->force. */
static void begin(const Task *t, Room *w, Ritz *out)
{
    const int m = (int)t->m, single = (int)t->single;
    const int64_t n = 6 * t->bodies;
    lanes stiff[MOST * MOST], mass[MOST * MOST], q[MOST * MOST];
    eliminate(t, w, all(t->shift), 0, 0, 0);
    for (int64_t i = 0; i < n * m; i++) w->next[i] = w->ahead[i] = all(t->force[i]);
    if (m == 7) solve(t, w, w->ahead, w->now, 7); /* six platform modes below all others, the usual case */
    else solve(t, w, w->ahead, w->now, m);
    const Layout at = {m, 1};
    gram(n, m, at, stiff, w->ahead, w->next);
    gram(n, m, at, mass, w->ahead, w->now);
    for (int i = 0; i < m * m; i++) stiff[i] += t->shift * mass[i];
    small(m, stiff, mass, out->values, q, 1e-6);
    for (int c = 0; c < m; c++) out->share[c] = share_of(t, w, w->ahead + (n - 6) * m, q, m, c);
    blend(n, m, at, w->force, w->now, q, single);
}

/* The wanted modes one by one, by steps of inverse iteration with a shift just below each value, and Rayleigh-Ritz on them: from M times them in
 * w->force to shapes (single, n) in w->now. What is of other modes falls in each step like the value's distance from
 * the shift over theirs. */
static void polish(const Task *t, Room *w, Ritz *known)
{
    const int m = (int)t->single;
    const int64_t n = 6 * t->bodies;
    lanes stiff[MOST * MOST], mass[MOST * MOST], q[MOST * MOST], values[MOST];
    for (int c = 0; c < m; c++) {
        lanes *f = w->force + c * n, *x = w->ahead + c * n, *g = w->next + c * n;
        const lanes shift = known->shift[c] = (1.0 - BESIDE) * known->values[c];
        eliminate(t, w, shift, 0, 0, 0);
        lanes before = all(1.0), between = before, after = before;
        for (int64_t step = 0; step < t->steps; step++) {
            memcpy(x, f, sizeof(lanes) * n);
            solve(t, w, x, g, 1);
            lanes sum[4] = {all(0.0), all(0.0), all(0.0), all(0.0)};
            for (int64_t i = 0; i < n; i += 2) /* n is even */
                UNROLL for (int k = 0; k < 2; k++) sum[k] += x[i + k] * f[i + k], sum[2 + k] += x[i + k] * g[i + k];
            between = sum[0] + sum[1], after = sum[2] + sum[3];
            if (step + 1 == t->steps) break;
            before = after;
            memcpy(f, g, sizeof(lanes) * n);
        }
        const lanes square = 1.0 - between * between / (before * after);
        known->sine[c] = root(pick(square > 0.0, square, all(0.0)));
        known->sine[c] = pick(square == square, known->sine[c], square);
        known->quotient[c] = between / before;
    }
    const Layout at = {1, n};
    gram(n, m, at, mass, w->ahead, w->next);
    gram(n, m, at, stiff, w->ahead, w->force);
    for (int i = 0; i < m; i++)
        for (int j = 0; j <= i; j++) stiff[i * m + j] = stiff[j * m + i] = known->shift[j] * mass[i * m + j] + stiff[i * m + j];
    lanes length[MOST];
    for (int i = 0; i < m; i++) length[i] = root(mass[i * m + i]);
    small(m, stiff, mass, values, q, 1e-17);
    blend(n, m, at, w->now, w->ahead, q, m);
    memcpy(known->mix, q, sizeof(lanes) * m * m);
    for (int c = 0; c < m; c++) {
        known->values[c] = values[c];
        for (int k = 0; k < m; k++) known->part[c * m + k] = size_of(q[k * m + c]) * length[k];
        lanes one = all(1.0), seen[6];
        for (int i = 0; i < 6; i++) seen[i] = w->now[c * n + n - 6 + i];
        known->share[c] = share_of(t, w, seen, &one, 1, 0);
    }
}

/* ---- which modes are the platform's, one design at a time ---- */

typedef struct { int done, below, mask[MOST]; double shift; } Verdict;

static int apart(const double *values, int m, int needed, double together)
{
    while (needed < m && values[needed] - values[needed - 1] <= together * values[needed]) needed++;
    return needed;
}

static double left_over(const Task *t, const double *share, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++) sum += share[i];
    return t->shares - sum;
}

static void judge(const Task *t, const Ritz *known, int lane, Verdict *out)
{
    const int m = (int)t->m, count = (int)t->count, single = (int)t->single;
    double value[MOST], share[MOST], mean[MOST], frequency[MOST], least = INFINITY;
    int group[MOST], order[MOST], taken = 0, needed = 0;
    memset(out, 0, sizeof *out);
    for (int i = 0; i < m; i++) {
        value[i] = known->values[i][lane], share[i] = known->share[i][lane];
        if (!isfinite(value[i]) || value[i] <= 0.0) return;
        frequency[i] = sqrt(value[i]) / (2.0 * 3.14159265358979323846);
        group[i] = i && frequency[i] - frequency[i - 1] <= t->cluster * frequency[i] ? group[i - 1] : i;
    }
    for (int i = 0; i < m;) {
        int end = i;
        double sum = 0.0;
        while (end < m && group[end] == i) sum += share[end++];
        for (int k = i; k < end; k++) mean[k] = frequency[i] < t->limit ? sum / (end - i) : -INFINITY;
        i = end;
    }
    for (int i = 0; i < m; i++) {
        int place = i;
        for (; place > 0 && mean[order[place - 1]] < mean[i]; place--) order[place] = order[place - 1];
        order[place] = i;
    }
    for (int i = 0; i < m; i++)
        if (mean[order[i]] > -INFINITY && (i < count || group[order[i]] == group[order[count - 1]])) out->mask[order[i]] = 1;
    for (int i = 0; i < m; i++)
        if (out->mask[i]) taken++, needed = i + 1, least = mean[i] < least ? mean[i] : least;
    int first = single;
    while (first > needed && apart(value, m, first, t->together) != first) first--;
    if (taken != count || needed > first || apart(value, m, first, t->together) != first) return;
    const double ceiling = 4.0 * 9.86960440108935861883 * t->limit * t->limit;
    int below = first;
    while (below < m && !(left_over(t, share, below) < (below == first ? least : least - t->margin)))
        below = apart(value, m, below + 1, t->together);
    const int wide = below >= m;
    if (wide) {
        int reach = needed;
        while (reach < m && value[reach] < ceiling) reach++;
        below = apart(value, m, reach, t->together);
    }
    if (below >= m) return;
    out->below = below, out->shift = value[below - 1] + 0.1 * (value[below] - value[below - 1]);
    if (wide) {
        if (!(ceiling <= value[below])) return;
        if (ceiling > out->shift) out->shift = ceiling;
    }
    /* What of a single vector is of modes beyond: it has gone through (K - shift M)^-1 M, whose values there are 1 / (outer - shift) at most. */
    const double outer = below == first ? out->shift : value[first];
    double beyond[MOST];
    for (int k = 0; k < single; k++) {
        const double far = (outer - known->shift[k][lane]) * fabs(known->quotient[k][lane]) - 1.0;
        beyond[k] = k < first && far > known->sine[k][lane] ? known->sine[k][lane] / far : 1.0;
    }
    for (int i = 0; i < first; i++)
        if (out->mask[i]) {
            double angle = 0.0;
            for (int k = 0; k < single; k++) angle += known->part[i * single + k][lane] * beyond[k];
            if (!(angle * angle * outer / value[i] <= t->value) || !(angle <= t->angle)) return;
        }
    out->done = value[0] > BESIDE * value[first - 1];
}

/* ---- derivatives ---- */

enum { STIFFNESS, MASS, TURN, FIRST, SECOND, INERTIA };

/* Two modes i <= j of a cluster; those of a mode with itself come first. */
typedef struct { int i, j; } Pair;

/* Modes that derivatives are about, their means by cluster, and the pairs of different ones (`pairs` in all). */
typedef struct { const lanes *mean; const Pair *pair; int pairs; } Wanted;

/* `sum` (pairs) of a slot, += or = a_i b_j + a_j b_i, by a factor: of each mode with itself, or (`crossed`) of pairs of different ones. */
static INLINE void gain(lanes *sum, const lanes *a, const lanes *b, double factor, const int more, const Wanted *of, const int crossed, const int k)
{
    if (crossed)
        for (int p = k; p < of->pairs; p++) {
            const Pair at = of->pair[p];
            const lanes x = 0.5 * factor * (a[at.i] * b[at.j] + a[at.j] * b[at.i]);
            sum[p] = more ? sum[p] + x : x;
        }
    else
        UNROLL for (int p = 0; p < k; p++) sum[p] = more ? sum[p] + factor * a[p] * b[p] : factor * a[p] * b[p];
}

/* out (k) = the entries of a row of a law times x (k columns). */
static INLINE void weigh_row(lanes *out, const lanes *row, const int *column, int entries, const lanes *x, const int k)
{
    lanes sum[MODES];
    UNROLL for (int c = 0; c < k; c++) sum[c] = all(0.0);
    for (int at = 0; at < entries; at++) {
        const lanes own = row[column[at]], *y = x + column[at] * k;
        UNROLL for (int c = 0; c < k; c++) sum[c] += own * y[c];
    }
    UNROLL for (int c = 0; c < k; c++) out[c] = sum[c];
}

/* A link in the modes: twists of its ends in its axes (12, k), the same times - lambda, strains (6, k), motions of its place as either body moves it
 * (3, k each) in the stage's axes, forces less lambda times momenta on its ends (12, k) and their first halves in the stage's axes. */
typedef struct { lanes twist[12 * MODES], heavy[12 * MODES], strain[6 * MODES], seen[6 * MODES], force[12 * MODES], world[6 * MODES]; } Moved;

static INLINE void move_link(const Task *t, const Room *w, int64_t l, Moved *to, const Wanted *of, const int k)
{
    const lanes *r = w->number + t->start[2] + 9 * l;
    for (int side = 0; side < 2; side++) {
        const int64_t body = t->link[4 * l + 1 + side];
        lanes *e = to->twist + 6 * side * k, *u = to->seen + 3 * side * k;
        if (body < 0) {
            memset(e, 0, sizeof(lanes) * 6 * k);
            continue;
        }
        const lanes *a = w->number + t->start[3 + side] + 3 * l, *x = w->shapes + 6 * k * body, *o = x + 3 * k;
        UNROLL for (int c = 0; c < k; c++) {
            const lanes one = o[c], two = o[k + c], three = o[2 * k + c];
            const lanes p = u[c] = x[c] + (a[1] * three - a[2] * two);
            const lanes q = u[k + c] = x[k + c] + (a[2] * one - a[0] * three);
            const lanes s = u[2 * k + c] = x[2 * k + c] + (a[0] * two - a[1] * one);
            UNROLL for (int i = 0; i < 3; i++) {
                e[i * k + c] = r[i] * p + r[3 + i] * q + r[6 + i] * s;
                e[(3 + i) * k + c] = r[i] * one + r[3 + i] * two + r[6 + i] * three;
            }
        }
    }
    for (int i = 0; i < 6; i++)
        UNROLL for (int c = 0; c < k; c++) to->strain[i * k + c] = to->twist[(6 + i) * k + c] - to->twist[i * k + c];
    for (int i = 0; i < 12; i++)
        UNROLL for (int c = 0; c < k; c++) to->heavy[i * k + c] = -of->mean[c] * to->twist[i * k + c];
}

static INLINE void load_link(const Task *t, const Room *w, int64_t l, Moved *to, const int k)
{
    const lanes *r = w->number + t->start[2] + 9 * l, *stiff = w->number + t->start[0] + 36 * t->link[4 * l];
    const lanes *mass = w->number + t->start[1] + 144 * t->link[4 * l];
    const Law *law = w->law + t->link[4 * l];
    lanes pull[6 * MODES];
    for (int i = 0; i < 6; i++)
        weigh_row(pull + i * k, stiff + 6 * i, law->column + law->start[i], law->start[i + 1] - law->start[i], to->strain, k);
    for (int i = 0; i < 12; i++) {
        if (t->link[4 * l + 1 + i / 6] < 0) continue;
        lanes *f = to->force + i * k;
        weigh_row(f, mass + 12 * i, law->column + law->start[6 + i], law->start[7 + i] - law->start[6 + i], to->heavy, k);
        UNROLL for (int c = 0; c < k; c++) f[c] = i < 6 ? f[c] - pull[i * k + c] : f[c] + pull[(i - 6) * k + c];
    }
    for (int side = 0; side < 2; side++)
        for (int i = 0; i < 3 && t->link[4 * l + 1 + side] >= 0; i++) {
            const lanes *f = to->force + 6 * side * k;
            UNROLL for (int c = 0; c < k; c++)
                to->world[(3 * side + i) * k + c] = r[3 * i] * f[c] + r[3 * i + 1] * f[k + c] + r[3 * i + 2] * f[2 * k + c];
        }
}

/* Adds a link's share of every slot of its part to `sum`. */
static INLINE void law_slots(const Task *t, int64_t l, const Moved *at, lanes *sum, const Wanted *of, const int crossed, const int k, const int n)
{
    const int64_t part = t->link[4 * l];
    const int least = t->link[4 * l + 1] < 0 ? 6 : 0, most = t->link[4 * l + 2] < 0 ? 6 : 12;
    for (int64_t s = t->reach[part]; s < t->reach[part + 1]; s++, sum += n) {
        const int row = (int)t->slot[4 * s + 2], column = (int)t->slot[4 * s + 3];
        const double factor = row == column ? 1.0 : 2.0;
        if (t->slot[4 * s] == STIFFNESS) gain(sum, at->strain + row * k, at->strain + column * k, factor, 1, of, crossed, k);
        else if (row >= least && column < most) gain(sum, at->twist + row * k, at->heavy + column * k, factor, 1, of, crossed, k);
    }
}

/* Every slot about a link's place, into `sum`. */
static INLINE void place_slots(
    const Task *t, const Room *w, int64_t l, const Moved *at, lanes *sum, const Wanted *of, const int crossed, const int k, const int n)
{
    for (int64_t s = t->reach[t->parts + l]; s < t->reach[t->parts + l + 1]; s++, sum += n) {
        const int kind = (int)t->slot[4 * s], row = (int)t->slot[4 * s + 2], column = (int)t->slot[4 * s + 3];
        const int one = (row + 1) % 3, two = (row + 2) % 3;
        int more = 0;
        for (int side = kind == SECOND; side < (kind == FIRST ? 1 : 2); side++) {
            const int64_t body = t->link[4 * l + 1 + side];
            if (body < 0) continue;
            const lanes *o = w->shapes + 6 * k * body + 3 * k, *g = at->world + 3 * side * k, *f = at->force + (6 * side + column) * k;
            if (kind == TURN) {
                gain(sum, f, at->seen + (3 * side + row) * k, 2.0, more, of, crossed, k);
                gain(sum, f + 3 * k, o + row * k, 2.0, 1, of, crossed, k);
            } else {
                gain(sum, o + one * k, g + two * k, 2.0, 0, of, crossed, k);
                gain(sum, o + two * k, g + one * k, -2.0, 1, of, crossed, k);
            }
            more = 1;
        }
    }
}

/* From the slots of a group (a part, a link, a body) to variables; n is the number of pairs. */
static INLINE void contract(const Task *t, Room *w, int64_t group, const lanes *sum, const int n)
{
    sum -= t->reach[group] * n;
    for (int64_t e = t->about[group]; e < t->about[group + 1];) {
        const int64_t variable = t->entry[3 * e];
        lanes own[MODES], *to = w->slope + variable * n;
        if (n > MODES) {
            for (; e < t->about[group + 1] && t->entry[3 * e] == variable; e++)
                for (int p = 0; p < n; p++) to[p] += w->change[e] * sum[t->entry[3 * e + 1] * n + p];
            continue;
        }
        UNROLL for (int p = 0; p < n; p++) own[p] = to[p];
        for (; e < t->about[group + 1] && t->entry[3 * e] == variable; e++) {
            const lanes change = w->change[e], *of = sum + t->entry[3 * e + 1] * n;
            UNROLL for (int p = 0; p < n; p++) own[p] += change * of[p];
        }
        UNROLL for (int p = 0; p < n; p++) to[p] = own[p];
    }
}

/* All links, those of one part together, then the bodies' inertia. */
static INLINE void sum_slots(const Task *t, Room *w, const Wanted *of, const int k, const int n)
{
    Moved at;
    const int more = of->pairs > k;
    for (int64_t i = 0; i < t->variables * n; i++) w->slope[i] = all(0.0);
    for (int64_t i = 0; i < t->links; i++) {
        const int64_t l = t->alike[i], part = t->link[4 * l], place = t->parts + l;
        const int first = !i || t->link[4 * t->alike[i - 1]] != part, last = i + 1 == t->links || t->link[4 * t->alike[i + 1]] != part;
        const int law = t->reach[part] < t->reach[part + 1], moves = t->reach[place] < t->reach[place + 1];
        lanes *own = w->sum, *other = own + (t->reach[part + 1] - t->reach[part]) * n;
        if (first) memset(own, 0, sizeof(lanes) * (other - own));
        if (law || moves) move_link(t, w, l, &at, of, k);
        if (law) law_slots(t, l, &at, own, of, 0, k, n);
        if (law && more) law_slots(t, l, &at, own, of, 1, k, n);
        if (law && last) contract(t, w, part, own, n);
        if (!moves) continue;
        load_link(t, w, l, &at, k), place_slots(t, w, l, &at, other, of, 0, k, n);
        if (more) place_slots(t, w, l, &at, other, of, 1, k, n);
        contract(t, w, place, other, n);
    }
    for (int64_t b = 0; b < t->bodies; b++) {
        const int64_t group = t->parts + t->links + b;
        const lanes *x = w->shapes + 6 * k * b;
        lanes heavy[6 * MODES], *sum = w->sum;
        for (int i = 0; i < 6; i++)
            UNROLL for (int c = 0; c < k; c++) heavy[i * k + c] = -of->mean[c] * x[i * k + c];
        for (int64_t s = t->reach[group]; s < t->reach[group + 1]; s++, sum += n) {
            const int64_t row = t->slot[4 * s + 2], column = t->slot[4 * s + 3];
            gain(sum, x + row * k, heavy + column * k, row == column ? 1.0 : 2.0, 0, of, 0, k);
            if (more) gain(sum, x + row * k, heavy + column * k, row == column ? 1.0 : 2.0, 0, of, 1, k);
        }
        contract(t, w, group, w->sum, n);
    }
}

static void derive(const Task *t, Room *w, int64_t design, const lanes *value)
{
    const int k = (int)t->count;
    Pair pair[MODES * MODES];
    marks same[MODES * MODES];
    lanes mean[MODES];
    int pairs = 0, group[MODES];
    for (int lane = 0; lane < WIDTH; lane++) {
        for (int i = 0; i < k; i++) group[i] = i && value[i][lane] - value[i - 1][lane] <= t->cluster * value[i][lane] ? group[i - 1] : i;
        for (int i = 0; i < k; i++) {
            double sum = 0.0;
            int size = 0;
            for (int j = 0; j < k; j++) {
                if (group[j] == group[i]) sum += value[j][lane], size++;
                same[i * k + j][lane] = group[j] == group[i] ? -1 : 0;
            }
            mean[i][lane] = sum / size;
        }
    }
    for (int64_t b = 0; b < t->bodies; b++) {
        lanes q[9], *x = w->shapes + 6 * k * b, u[6];
        if (t->plane[2 * b] < 0) continue;
        axes_of(q, t, w, b);
        for (int c = 0; c < k; c++) {
            UNROLL for (int i = 0; i < 6; i++) u[SPOT[i]] = x[i * k + c];
            UNROLL for (int i = 0; i < 6; i++)
                x[i * k + c] = q[3 * (i % 3)] * u[i - i % 3] + q[3 * (i % 3) + 1] * u[i - i % 3 + 1] + q[3 * (i % 3) + 2] * u[i - i % 3 + 2];
        }
    }
    for (; pairs < k; pairs++) pair[pairs].i = pair[pairs].j = pairs;
    for (int i = 0; i < k; i++)
        for (int j = i + 1; j < k; j++)
            if (any(same[i * k + j])) pair[pairs].i = i, pair[pairs++].j = j;
    const Wanted of = {mean, pair, pairs};
    if (k == 6 && pairs == 6) sum_slots(t, w, &of, 6, 6); /* the usual case, unrolled by the compiler */
    else if (k == 6) sum_slots(t, w, &of, 6, pairs);
    else sum_slots(t, w, &of, k, pairs);
    for (int p = 0; p < pairs; p++) {
        const int i = pair[p].i, j = pair[p].j, row = p < k ? p : k + i * (2 * k - i - 1) / 2 + j - i - 1;
        for (int64_t variable = 0; variable < t->variables; variable++)
            store(t->slopes + (row * t->variables + variable) * t->stride + design, (lanes)(same[i * k + j] & (marks)w->slope[variable * pairs + p]));
    }
}

/* ---- one vector of designs ---- */

/* The modes of the lanes that are done in this round and were not before. */
static void keep(const Task *t, Room *w, const Ritz *known, const Verdict *verdict, marks fresh, lanes *value, lanes *share)
{
    const int m = (int)t->single, k = (int)t->count;
    const int64_t n = 6 * t->bodies;
    for (int c = 0; c < k; c++) {
        int from[WIDTH], first = -1, alike = 1;
        for (int lane = 0; lane < WIDTH; lane++) {
            if (!fresh[lane]) continue;
            int at = 0;
            for (int seen = -1; at < m; at++)
                if (verdict[lane].mask[at] && ++seen == c) break;
            from[lane] = at, first = first < 0 ? at : first, alike &= at == first;
            value[c][lane] = known->values[at][lane], share[c][lane] = known->share[at][lane];
        }
        if (!t->variables) continue;
        for (int64_t r = 0; r < n; r++) {
            lanes *to = w->shapes + r * k + c;
            if (alike) *to = pick(fresh, w->now[first * n + r], *to);
            else
                for (int lane = 0; lane < WIDTH; lane++)
                    if (fresh[lane]) (*to)[lane] = w->now[from[lane] * n + r][lane];
        }
    }
}

static void designs(const Task *t, Room *w, int64_t design)
{
    Verdict verdict[WIDTH];
    Ritz known;
    lanes value[MODES], share[MODES], negative = all(0.0), least = all(INFINITY), shift = all(0.0);
    int left = WIDTH;
    for (int i = 0; i < t->count; i++) value[i] = all(1.0), share[i] = all(0.0);
    if (t->variables) memset(w->shapes, 0, sizeof(lanes) * 6 * t->bodies * t->count);
    for (int lane = 0; lane < WIDTH; lane++) verdict[lane].done = 0;
    const marks bad = assemble(t, w);
    if (!any(~bad)) {
        for (int lane = 0; lane < WIDTH; lane++) t->good[design + lane] = -1;
        return;
    }
    begin(t, w, &known);
    for (int64_t round = 0; round < t->rounds && left; round++) {
        if (round) blend(6 * t->bodies, (int)t->single, (Layout){1, 6 * t->bodies}, w->force, w->next, known.mix, (int)t->single);
        polish(t, w, &known);
        marks fresh = {0};
        left = 0;
        for (int lane = 0; lane < WIDTH; lane++) {
            if (verdict[lane].done) continue;
            judge(t, &known, lane, &verdict[lane]);
            if (verdict[lane].done) fresh[lane] = -1, shift[lane] = verdict[lane].shift;
            else left++;
        }
        if (any(fresh)) keep(t, w, &known, verdict, fresh, value, share);
    }
    eliminate(t, w, shift, 1, &negative, &least);
    for (int lane = 0; lane < WIDTH; lane++)
        t->good[design + lane] = bad[lane] ? -1 : verdict[lane].done && least[lane] > t->pivot && negative[lane] == (double)verdict[lane].below;
    for (int i = 0; i < t->count; i++)
        store(t->values + i * t->stride + design, value[i]), store(t->share + i * t->stride + design, share[i]);
    if (t->variables) derive(t, w, design, value);
}

/* ---- what of the numbers is the same in every design ---- */

/* Rows (those of a list, each third of its numbers, or all) that are not the same in all designs, and how many; the others go to each of AHEAD vectors here,
 * once. What is below the diagonal of symmetric matrices is never read: its `mirror` stands for both. */
static int64_t vary(
    lanes *to, const double *from, const int64_t *row, int64_t rows, int64_t stride, int64_t designs, const int64_t *mirror, int64_t *varying)
{
    int64_t count = 0;
    for (int64_t i = 0; i < rows; i++) {
        if (mirror && mirror[i] < i) continue;
        const double *own = from + (row ? row[3 * i] : i) * stride;
        const lanes first = all(*own);
        marks other = {0};
        for (int64_t design = 0; design < designs && !any(other); design += 4 * WIDTH)
            for (int64_t k = 0; k < 4 && design + k * WIDTH < designs; k++) other |= load_at(own, design + k * WIDTH, designs) != first;
        if (any(other)) varying[count++] = i;
        else
            for (int64_t k = 0; k < AHEAD; k++) to[k * rows + i] = to[k * rows + (mirror ? mirror[i] : i)] = first;
    }
    return count;
}

/* The varying rows of AHEAD vectors of designs, vector by vector. */
static void gather(
    lanes *to, const double *from, const int64_t *row, int64_t rows, int64_t stride, int64_t design, int64_t designs, const int64_t *mirror,
    const int64_t *varying, int64_t count)
{
    for (int64_t i = 0; i < count; i++) {
        const int64_t at = varying[i], other = mirror ? mirror[at] : at;
        for (int64_t k = 0; k < AHEAD && design + k * WIDTH < designs; k++)
            to[k * rows + at] = to[k * rows + other] = load_at(from + (row ? row[3 * at] : at) * stride, design + k * WIDTH, designs);
    }
}

/* A matrix of a law (`rows` x `rows`), whose entries in all designs are zero where it is not `filled`. */
static void outline(const char *filled, int rows, int *zero, int *start, int *column)
{
    const int blocks = rows / 3;
    for (int i = 0; i < blocks * blocks; i++) zero[i] = 1;
    for (int i = 0; i < rows; i++) {
        start[i + 1] = start[i];
        for (int k = 0; k < rows; k++)
            if (filled[rows * i + k]) zero[blocks * (i / 3) + k / 3] = 0, column[start[i + 1]++] = k;
    }
}

static void outlines(const Task *t, Law *law, const lanes *number, const int64_t *varying, int64_t count, char *filled)
{
    for (int64_t i = 0; i < t->numbers; i++) filled[i] = number[i][0] != 0.0;
    for (int64_t i = 0; i < count; i++) filled[varying[i]] = filled[t->mirror[varying[i]]] = 1;
    for (int64_t part = 0; part < t->parts; part++, law++) {
        law->start[0] = 0;
        outline(filled + t->start[0] + 36 * part, 6, law->zero, law->start, law->column);
        outline(filled + t->start[1] + 144 * part, 12, law->zero + 4, law->start + 6, law->column);
    }
}

int64_t flexstage_width(void) { return WIDTH; }

/* Every design of the task; 0, or 1 where that is too much. */
int64_t flexstage_modes(const Task *t)
{
    const int64_t own = OWN * t->bodies, edge = 36 * t->edges, block = 6 * t->bodies * t->m, pairs = t->count * (t->count + 1) / 2;
    const int64_t sizes[] = {AHEAD * t->numbers, AHEAD * t->entries, own, edge, own, edge, own, edge, block, block, block, block,
                             6 * t->bodies * t->count, t->widest * pairs, t->variables * pairs};
    const int count = sizeof sizes / sizeof *sizes;
    int64_t total = 0;
    for (int i = 0; i < count; i++) total += sizes[i] + 1;
    if (t->m > MOST || t->count > MODES || t->single >= t->m) return 1;
    lanes *memory = aligned_alloc(sizeof(lanes), sizeof(lanes) * total), *at = memory;
    Room w;
    lanes **parts[] = {&w.numbers, &w.changes, &w.stiff, &w.stiff_edge, &w.mass, &w.mass_edge, &w.other, &w.other_edge,
                       &w.now, &w.next, &w.force, &w.ahead, &w.shapes, &w.sum, &w.slope};
    for (int i = 0; i < count; i++) *parts[i] = at, at += sizes[i] + 1;
    int64_t *const varying = malloc(sizeof(int64_t) * (t->numbers + t->entries)), *const changing = varying + t->numbers;
    char *const filled = malloc(t->numbers);
    int64_t *const crossing = malloc(sizeof(int64_t) * 180 * t->links);
    w.law = malloc(sizeof(Law) * t->parts);
    w.fills = 0;
    for (int64_t u = 0; u < t->updates; u++) w.fills |= t->update[3 * u + 2] >= 0;
    const int short_of = !memory || !varying || !filled || !crossing || !w.law;
    if (!short_of) {
        const int64_t some = vary(w.numbers, t->numbers_, 0, t->numbers, t->numbers_stride, t->designs, t->mirror, varying);
        const int64_t other = vary(w.changes, t->changes, t->entry + 2, t->entries, t->slopes_stride, t->designs, 0, changing);
        outlines(t, w.law, w.numbers, varying, some, filled);
        w.crossing = crossing, w.crossings = 0;
        for (int64_t l = 0; l < t->links; l++)
            for (int64_t i = 0; i < 36 + 144 && t->normal[l] >= 0; i++) {
                const int row = (int)(i < 36 ? i / 6 : (i - 36) / 12 % 6), column = (int)(i < 36 ? i % 6 : (i - 36) % 6);
                const int64_t at = i < 36 ? t->start[0] + 36 * t->link[4 * l] + i : t->start[1] + 144 * t->link[4 * l] + i - 36;
                if (filled[at] && (row / 3 == column / 3) != ((row % 3 == t->normal[l]) == (column % 3 == t->normal[l]))) w.crossing[w.crossings++] = at;
            }
        for (int64_t first = 0; first < t->designs; first += AHEAD * WIDTH) {
            gather(w.numbers, t->numbers_, 0, t->numbers, t->numbers_stride, first, t->designs, t->mirror, varying, some);
            gather(w.changes, t->changes, t->entry + 2, t->entries, t->slopes_stride, first, t->designs, 0, changing, other);
            for (int64_t k = 0; k < AHEAD && first + k * WIDTH < t->designs; k++) {
                w.number = w.numbers + k * t->numbers, w.change = w.changes + k * t->entries;
                designs(t, &w, first + k * WIDTH);
            }
        }
    }
    free(memory), free(varying), free(filled), free(crossing), free(w.law);
    return short_of;
}
