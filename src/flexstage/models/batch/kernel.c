/* Platform modes of many designs, several of them in each vector. A "lane" is one design; nothing that happens in a lane depends on the others, so
 * results do not depend on which designs are computed together. Blocks, elimination, which modes are the platform's and derivatives are those of
 * blocks.py, factor.py, subspace.py and slopes.py, where they are explained; the wanted modes are found singly:
 *
 * 1. Z = (K - sigma M)^-1 F for the inertial forces F of the family's own modes, sigma amid their values; Rayleigh-Ritz on Z.
 * 2. For each wanted mode x of these, sigma just below its value and T = (K - sigma M)^-1 M: y = T x, and once more where its vector asks for it.
 *    Rayleigh-Ritz on the y alone, with K y = sigma M y + M x.
 * 3. T's Rayleigh quotient theta at x and the residual |y - theta x| in M bound what y has of modes whose lambda is `outer` or more, for which T is
 *    1 / (outer - sigma) at most: its sine is (sine of the angle between x and y) / ((outer - sigma) theta - 1) at most.
 * 4. As many pivots of K - shift M are negative as values lie below the shift: none is missed.
 *
 * Own blocks of bodies are lower triangles by rows, edges 6x6 by rows; vectors are [body][6][copy][m]; every entry is a vector of WIDTH designs.
 *
 * A leg that is symmetric about a plane, in which every body has one that comes later, is a tree: in axes of its own its blocks are two of 3x3,
 * which have nothing in common: x, y, rz and z, rx, ry. Own blocks are two lower triangles there, edges two of 3x3. It ends at a port: the platform as it
 * moves in the leg's axes where a link of the leg ends on it. Equal legs have equal matrices there, wherever on the platform they end, which are assembled
 * and eliminated once; their motions are columns side by side.
 */
#include "lanes.h"

#define MOST 16     /* vectors of a block */
#define MODES 12    /* modes that may be asked for */
#define USUAL 6      /* modes, where the platform's are below all others: known to the compiler */
#define ROUNDING 1e-15
#define BESIDE 1e-7 /* how far below its value a single mode's shift is: its matrix is never singular */
#define ABOVE 5e-3  /* how far above the last of all values that are sought it is counted that there are no more */

typedef double loose __attribute__((vector_size(WIDTH * 8), aligned(8)));

typedef struct {
    /* sizes */
    int64_t designs, numbers_stride, numbers_portion, slopes_stride, slopes_portion, stride, bodies, links, edges, updates, numbers, m, count, rounds, once, variables, widest, single, parts, ports, gates, rows;
    /* tables */
    const int64_t *link;    /* links x (part, place of first body, place of second body, edge); -1: the ground, no edge */
    const int64_t *range;   /* bodies + 1: where the edges of each body begin */
    const int64_t *later;   /* edges: the later body, or the port that stands for the platform */
    const int64_t *heavy;   /* edges: whether some link is on it */
    const int64_t *product; /* bodies + 1: where the updates of each body begin */
    const int64_t *update;  /* updates x (edge, edge, target); -1: the later body's own block */
    const int64_t *mirror;  /* numbers: the one that is the same by symmetry, or itself */
    const int64_t *inertia; /* bodies: where the inertia of the body at that place begins among the numbers */
    const int64_t *start;   /* stiffness, mass, turn, first, second */
    const int64_t *slot;    /* slots x (kind, owner or place, row, column, sign of what the other end of a mirrored mass has; 0: it is not) */
    const int64_t *reach;   /* groups + 1: where the slots of each group begin: parts (laws), links (places), bodies by place (inertia) */
    const int64_t *about;   /* groups + 1: where their runs begin */
    const int64_t *run;     /* runs x (variable, where its entries begin), by group, and where the last one's end */
    const int64_t *entry;   /* entries x (slot, row of `changes`) */
    const int64_t *alike;   /* links, those of one part together */
    const int64_t *gate;    /* gates x (port, link, axis, link to the platform, its side, copy): one for each tree, which has the axes of its link, of which
                             * one is normal to the plane of symmetry */
    const int64_t *through; /* bodies, then links: the gate of their tree; -1: in none, in the stage's axes */
    const int64_t *normal;  /* links: the axis of each that is normal to its tree's plane; -1: in none */
    const int64_t *model;   /* bodies, then links: the one of an equal tree whose matrices serve for it, or itself */
    const int64_t *row;     /* bodies, then ports: the row of their first component in vectors */
    const int64_t *copies;  /* bodies, then ports: how many equal ones there are, whose rows stand side by side */
    const int64_t *nth;     /* bodies, then ports, x 2: how many come before it, and which of those before the later one it is */
    const int64_t *tree;    /* ports + 1: where the bodies of each tree that stand for themselves begin in the following */
    const int64_t *member;  /* those bodies, in their order */
    const double *force;    /* rows x m: inertial forces of the modes to begin with */
    const double *numbers_; /* numbers, those of PORTION designs beside each other: numbers_stride from row to row, numbers_portion to those of the next */
    const int64_t *still;   /* numbers: whether it is known that one is the same in all designs */
    const double *changes;  /* entries, in the same way */
    /* settings */
    double shift, value, angle, cluster, together, threshold, margin, pivot, skew, span;
    /* results */
    double *values, *share; /* count x stride, whole vectors of designs */
    int64_t *good;          /* designs: 1, 0 for what is not proved, -1 where legs have not these planes */
    double *slopes;         /* count x variables x stride: of each mode with itself */
    double *between;        /* vectors of designs x pairs (i, j > i) by rows x variables x WIDTH, where `crossed` */
    int64_t *crossed;       /* vectors of designs: whether some modes are clusters in one of them; 0 before */
} Task;

#define INLINE inline __attribute__((always_inline))
#if defined(__clang__)
#define UNROLL /* does so by itself, and worse where told to */
#define EACH_MODE
#else
#define UNROLL _Pragma("GCC unroll 36") /* small fixed loops: what they work on stays in registers */
#define EACH_MODE _Pragma("GCC unroll 12")
#endif

/* ---- lanes ---- */

static inline lanes root(lanes a) { for (int i = 0; i < WIDTH; i++) a[i] = sqrt(a[i]); return a; }
static inline lanes load(const double *p) { return *(const loose *)p; }
/* So many; the last one stands for those that are not there. Apart, lest loops that hardly ever want it make room for it. */
static __attribute__((noinline, cold)) lanes load_some(const double *p, int64_t count)
{
    lanes r;
    for (int i = 0; i < WIDTH; i++) r[i] = p[i < count ? i : count - 1];
    return r;
}
static inline void store(double *p, lanes a) { *(loose *)p = a; }

#define PORTION 32 /* designs that stand beside each other */

/* Where a vector of designs stands in rows: how far from where they begin, how far the next vector is from it, and how many of its designs there are. */
typedef struct { int64_t at, next, count; } Spot;

static inline Spot spot_of(int64_t design, int64_t designs, int64_t portion)
{
    const int64_t left = designs - design, next = design % PORTION + WIDTH < PORTION ? WIDTH : portion + WIDTH - PORTION;
    return (Spot){design / PORTION * portion + design % PORTION, left > WIDTH ? next : 0, left < WIDTH ? left : WIDTH};
}

/* What a row has there; asks for what the next vector will want of it. */
static inline lanes read_row(const double *row, Spot spot)
{
    __builtin_prefetch(row + spot.at + spot.next, 0, 2);
    return spot.count == WIDTH ? load(row + spot.at) : load_some(row + spot.at, spot.count);
}

/* ---- 6x6 blocks ---- */

#define OWN 21
#define LOWER(i, k) ((i) * ((i) + 1) / 2 + (k)) /* k <= i */

#define HALF(h, i, k) (6 * (h) + LOWER(i, k)) /* of an own block of a tree; edges: 9 * h + 3 * i + k */

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

/* n columns of y (6, m) += a x or -= a x: each entry of a is used n times. */
static INLINE void multiply(lanes *restrict y, const lanes *restrict a, const lanes *x, int m, const int kind, const int negative, const int n)
{
    UNROLL for (int r = 0; r < 6; r++) {
        lanes s[4];
        UNROLL for (int k = 0; k < n; k++) s[k] = y[r * m + k];
        UNROLL for (int c = 0; c < 6; c++) {
            const lanes e = entry(a, r, c, kind);
            UNROLL for (int k = 0; k < n; k++) s[k] = negative ? s[k] - e * x[c * n + k] : s[k] + e * x[c * n + k];
        }
        UNROLL for (int k = 0; k < n; k++) y[r * m + k] = s[k];
    }
}

/* own (a lower triangle of `size`) = L D L^T: L below the diagonal, D^-1 on it. */
static INLINE void invert(lanes *own, lanes *pivot, const int size)
{
    lanes a[OWN];
    UNROLL for (int i = 0; i < LOWER(size, 0); i++) a[i] = own[i];
    UNROLL for (int s = 0; s < size; s++) {
        const lanes inverse = 1.0 / (pivot[s] = a[LOWER(s, s)]);
        UNROLL for (int i = s + 1; i < size; i++) {
            const lanes l = a[LOWER(i, s)] * inverse;
            for (int k = s + 1; k <= i; k++) a[LOWER(i, k)] -= l * a[LOWER(k, s)];
        }
        UNROLL for (int i = s + 1; i < size; i++) a[LOWER(i, s)] *= inverse;
        a[LOWER(s, s)] = inverse;
    }
    UNROLL for (int i = 0; i < LOWER(size, 0); i++) own[i] = a[i];
}

/* Edges of K - shift M: L^-1 times themselves, of an own block. */
static INLINE void reduce(lanes *edge, const lanes *stiff, const lanes *mass, lanes shift, const lanes *own, const int fills)
{
    UNROLL for (int half = 0; half < 6; half += 3) {
        lanes x[18];
        UNROLL for (int i = 0; i < 18; i++) {
            const int at = half + 6 * (i / 3) + i % 3;
            x[i] = fills ? edge[at] : stiff[at] - shift * mass[at];
        }
        UNROLL for (int s = 0; s < 6; s++)
            UNROLL for (int i = s + 1; i < 6; i++)
                UNROLL for (int c = 0; c < 3; c++) x[3 * i + c] -= own[LOWER(i, s)] * x[3 * s + c];
        UNROLL for (int i = 0; i < 18; i++) edge[half + 6 * (i / 3) + i % 3] = x[i];
    }
}

/* Three rows of an own block from `first` on -= x^T D x. */
static INLINE void update(lanes *restrict to, const lanes *restrict x, const lanes *restrict a, const int first)
{
    lanes sum[OWN];
    UNROLL for (int i = first; i < first + 3; i++)
        UNROLL for (int k = 0; k <= i; k++) sum[LOWER(i, k)] = to[LOWER(i, k)];
    UNROLL for (int r = 0; r < 6; r++)
        UNROLL for (int i = first; i < first + 3; i++) {
            const lanes scaled = x[6 * r + i] * a[LOWER(r, r)];
            for (int k = 0; k <= i; k++) sum[LOWER(i, k)] -= scaled * x[6 * r + k];
        }
    UNROLL for (int i = first; i < first + 3; i++)
        UNROLL for (int k = 0; k <= i; k++) to[LOWER(i, k)] = sum[LOWER(i, k)];
}

/* n columns u (6, n): L^-1 u. */
static INLINE void lower(lanes *u, const lanes *a, const int n)
{
    UNROLL for (int s = 0; s < 6; s++)
        UNROLL for (int i = s + 1; i < 6; i++)
            UNROLL for (int k = 0; k < n; k++) u[i * n + k] -= a[LOWER(i, s)] * u[s * n + k];
}

/* L^-T u. */
static INLINE void upper(lanes *u, const lanes *a, const int n)
{
    UNROLL for (int i = 5; i > 0; i--)
        UNROLL for (int s = 0; s < i; s++)
            UNROLL for (int k = 0; k < n; k++) u[s * n + k] -= a[LOWER(i, s)] * u[i * n + k];
}

/* `what` with three of `wide` columns from j on at once, then with what is left of them. */
#define IN_THREES(what)                                                   \
    {                                                                     \
        int j = 0;                                                        \
        for (; j + 3 <= wide; j += 3) { enum { n = 3 }; what; }           \
        if (wide - j == 2) { enum { n = 2 }; what; }                      \
        else if (wide - j == 1) { enum { n = 1 }; what; }                 \
    }
/* The same; the usual numbers of columns are known to the compiler. */
#define IN_COLUMNS(columns, what)                                         \
    {                                                                     \
        if ((columns) == 1) { enum { wide = 1, j = 0, n = 1 }; what; }      \
        else if ((columns) == 2) { enum { wide = 2, j = 0, n = 2 }; what; } \
        else if ((columns) == 3) { enum { wide = 3, j = 0, n = 3 }; what; } \
        else { const int wide = (columns); IN_THREES(what) }              \
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
static INLINE void join(lanes *out, const lanes *p, const lanes *a, double sign, const int kind)
{
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < (kind == SYMMETRIC ? i + 1 : 6); k++) {
            lanes x = p[6 * i + k];
            if (i > 2) x += p[6 * ((i + 1) % 3) + k] * a[(i + 2) % 3] - p[6 * ((i + 2) % 3) + k] * a[(i + 1) % 3];
            out[kind == SYMMETRIC ? LOWER(i, k) : 6 * i + k] += sign * x;
        }
}

/* What of a part's law and mass is not zero in every design: 3x3 blocks (4 and 16) that are; columns by row (6 and 12). */
typedef struct { int zero[20], start[19], column[180]; } Law;

/* The axes of a leg (columns, the normal last), and the arm of its port in them. */
typedef struct { lanes q[9], arm[3]; } View;

/* A link's axes in those of its leg: the two in the plane (2x2) and the normal; arms in the leg's axes. */
typedef struct { lanes p[4], s, arm[2][2]; int spot[6]; } Side;

typedef struct {
    Law *law;
    int64_t *crossing, crossings;    /* entries of laws that are zero where the plane is one of symmetry, and are not in every design */
    int fills;                       /* whether elimination makes edges */
    int64_t design;                  /* the first of these designs */
    Spot spot;                       /* where they stand in rows of `changes` */
    lanes *number;                   /* their numbers */
    lanes *stiff, *stiff_edge;       /* K */
    lanes *mass, *mass_edge;         /* M */
    lanes *other, *other_edge;       /* K - shift M factored */
    lanes *now, *next, *force, *ahead, *start; /* blocks of vectors; those to begin with are the same in all lanes */
    lanes *found, *shapes, *placed;  /* modes (count, rows), where they are kept, and of each body in the stage's axes (6 bodies, count) */
    lanes root[OWN];                 /* L D L^T of one over the platform's compliance, as `invert` leaves it */
    View *view;                      /* of every gate */
    Side *side;                      /* of every link of a leg with a plane */
    lanes *sum, *slope;              /* slots of a group x pairs, variables x pairs */
} Room;

/* ---- assembly in axes of a plane ---- */

static const int SPOT[6] = {0, 1, 5, 2, 3, 4}; /* x, y, rz, z, rx, ry among x, y, z, rx, ry, rz */

/* What stands for a body of a link in its tree's matrices: its port for the platform. */
static INLINE int64_t end_of(const Task *t, int64_t gate, int64_t body) { return gate >= 0 && body == t->bodies - 1 ? t->bodies + t->gate[6 * gate] : body; }

static INLINE lanes along(const lanes *q, int i, const lanes *v, int step) { return q[i] * v[0] + q[3 + i] * v[step] + q[6 + i] * v[2 * step]; }

/* Says in which lanes the link is not of that plane. */
static INLINE marks lay(const Task *t, const Room *w, int64_t l, const View *view, Side *out)
{
    const lanes *r = w->number + t->start[2] + 9 * l, *q = view->q;
    const int normal = (int)t->normal[l], one = (normal + 1) % 3, two = (normal + 2) % 3;
    const int spot[6] = {one, two, 3 + normal, normal, 3 + one, 3 + two};
    memcpy(out->spot, spot, sizeof spot);
    out->p[0] = along(q, 0, r + one, 3), out->p[1] = along(q, 0, r + two, 3);
    out->p[2] = along(q, 1, r + one, 3), out->p[3] = along(q, 1, r + two, 3);
    out->s = along(q, 2, r + normal, 3);
    marks bad = ~(size_of(along(q, 2, r + one, 3)) + size_of(along(q, 2, r + two, 3)) <= t->skew);
    for (int side = 0; side < 2; side++) {
        const int64_t body = t->link[4 * l + 1 + side];
        out->arm[side][0] = out->arm[side][1] = all(0.0);
        if (body < 0) continue;
        const lanes *arm = w->number + t->start[3 + side] + 3 * l;
        lanes own[3];
        for (int i = 0; i < 3; i++) own[i] = along(q, i, arm, 1) - (body == t->bodies - 1 ? view->arm[i] : all(0.0));
        out->arm[side][0] = own[0], out->arm[side][1] = own[1];
        bad |= ~(size_of(own[2]) <= t->skew * t->span);
    }
    return bad;
}

/* In which lanes two links lie otherwise in their legs. */
static INLINE marks unlike(const Task *t, const Side *a, const Side *b)
{
    marks bad = ~(size_of(a->s - b->s) <= t->skew);
    UNROLL for (int i = 0; i < 4; i++)
        bad |= ~(size_of(a->p[i] - b->p[i]) <= t->skew) | ~(size_of(a->arm[i / 2][i % 2] - b->arm[i / 2][i % 2]) <= t->skew * t->span);
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

/* Whether an entry is in one of the two 3x3 blocks. */
#define WITHIN(i, k) ((i) / 3 == (k) / 3)

/* p = n T(b) and out += sign T(a)^T p as `carried` and `join`, in the plane. */
static INLINE void carried_plane(lanes *p, const lanes *n, const lanes *b)
{
    UNROLL for (int i = 0; i < 36; i++)
        if (WITHIN(i / 6, i % 6)) p[i] = n[i];
    UNROLL for (int i = 0; i < 18; i += 6) {
        p[i + 2] += n[i] * b[1] - n[i + 1] * b[0];
        p[i + 22] -= n[i + 21] * b[1];
        p[i + 23] += n[i + 21] * b[0];
    }
}

static INLINE void join_plane(lanes *out, const lanes *p, const lanes *a, double sign, const int kind)
{
    UNROLL for (int i = 0; i < 6; i++)
        UNROLL for (int k = 0; k < 6; k++) {
            if (!WITHIN(i, k) || (kind == SYMMETRIC && k > i)) continue;
            lanes x = p[6 * i + k];
            if (i == 2) x += p[k] * a[1] - p[6 + k] * a[0];
            if (i == 4) x -= p[18 + k] * a[1];
            if (i == 5) x += p[18 + k] * a[0];
            out[kind == SYMMETRIC ? HALF(i / 3, i % 3, k % 3) : 9 * (i / 3) + 3 * (i % 3) + k % 3] += sign * x;
        }
}

/* An own block of the platform += one of a port, as the platform moves in the stage's axes. */
static INLINE void open_own(lanes *own, const lanes *s, const View *at)
{
    const lanes *q = at->q, one = at->arm[0], two = at->arm[1], far = at->arm[2], zero = all(0.0), square = far * far;
    const lanes a = s[HALF(0, 0, 0)], b = s[HALF(0, 1, 0)], c = s[HALF(0, 1, 1)], z = s[HALF(1, 0, 0)];
    const lanes e = s[HALF(0, 2, 0)] + a * two - b * one, f = s[HALF(0, 2, 1)] + b * two - c * one; /* about the platform's point, in the plane */
    const lanes g = s[HALF(1, 1, 0)] - z * two, h = s[HALF(1, 2, 0)] + z * one;
    const lanes spin = s[HALF(0, 2, 2)] + two * (s[HALF(0, 2, 0)] + e) - one * (s[HALF(0, 2, 1)] + f);
    const lanes roll = s[HALF(1, 1, 1)] - two * (s[HALF(1, 1, 0)] + g), mixed = s[HALF(1, 2, 1)] - two * s[HALF(1, 2, 0)] + one * g;
    const lanes pitch = s[HALF(1, 2, 2)] + one * (s[HALF(1, 2, 0)] + h);
    const lanes turned[9] = {c * far, -b * far, f, -a * far, zero, zero, zero, zero, zero};
    const lanes push[9] = {a, b, zero, b, c, zero, zero, zero, z};
    const lanes cross[9] = {b * far, turned[3], e, turned[0], turned[1], f, g, h, zero}; /* of forces by turns */
    const lanes twist[9] = {roll + c * square, mixed - b * square, f * far, zero, pitch + a * square, -e * far, zero, zero, spin};
    UNROLL for (int i = 0; i < 3; i++) {
        const lanes x = q[3 * i], y = q[3 * i + 1], z = q[3 * i + 2];
        const lanes p[3] = {x * push[0] + y * push[1], x * push[1] + y * push[4], z * push[8]};
        const lanes m[3] = {x * twist[0] + y * twist[1] + z * twist[2], x * twist[1] + y * twist[4] + z * twist[5], x * twist[2] + y * twist[5] + z * twist[8]};
        const lanes g[3] = {x * cross[0] + y * cross[3] + z * cross[6], x * cross[1] + y * cross[4] + z * cross[7], x * cross[2] + y * cross[5]};
        UNROLL for (int k = 0; k < 3; k++) {
            const lanes *r = q + 3 * k;
            if (k <= i) own[LOWER(i, k)] += p[0] * r[0] + p[1] * r[1] + p[2] * r[2];
            if (k <= i) own[LOWER(3 + i, 3 + k)] += m[0] * r[0] + m[1] * r[1] + m[2] * r[2];
            own[LOWER(3 + k, i)] += g[0] * r[0] + g[1] * r[1] + g[2] * r[2];
        }
    }
}

/* What the ports' own blocks add to the platform's. */
static INLINE void open_ports(const Task *t, const Room *w, lanes *own, const lanes *from)
{
    for (int64_t g = 0; g < t->gates; g++) open_own(own, from + OWN * (t->bodies + t->gate[6 * g]), w->view + g);
}

/* One of a link's own blocks. */
static INLINE void add_own(lanes *own, const lanes *law, const int stride, const lanes *r, const int *zero, const lanes *arm)
{
    lanes n[36], p[36];
    turn(n, law, stride, r, zero, 1), carried(p, n, arm), join(own, p, arm, 1.0, SYMMETRIC);
}

/* A link's edge of K or M (`symmetric`: K). */
static INLINE void add_edge(
    lanes *edge, const lanes *law, const int stride, const lanes *r, const int *zero, const lanes *first, const lanes *second, double sign, const int symmetric)
{
    lanes n[36], p[36];
    turn(n, law, stride, r, zero, symmetric), carried(p, n, second), join(edge, p, first, sign, PLAIN);
}

/* Adds a link in the stage's axes. */
static void assemble_whole(const Task *t, Room *w, int64_t l)
{
    const int64_t part = t->link[4 * l], *body = t->link + 4 * l + 1, e = t->link[4 * l + 3];
    const lanes *k = w->number + t->start[0] + 36 * part, *m = w->number + t->start[1] + 144 * part, *r = w->number + t->start[2] + 9 * l;
    const lanes *arm[2] = {w->number + t->start[3] + 3 * l, w->number + t->start[4] + 3 * l};
    const int *zero = w->law[part].zero;
    lanes crossed[36];
    for (int side = 0; side < 2; side++) {
        if (body[side] < 0) continue;
        add_own(w->stiff + OWN * body[side], k, 6, r, zero, arm[side]);
        add_own(w->mass + OWN * body[side], m + 78 * side, 12, r, zero + 4 + 10 * side, arm[side]);
    }
    if (e < 0) return;
    const int one = body[0] > body[1], two = 1 - one;
    int none[4];
    for (int i = 0; i < 36; i++) crossed[i] = one ? m[72 + 12 * (i / 6) + i % 6] : m[6 + 12 * (i / 6) + i % 6];
    for (int i = 0; i < 4; i++) none[i] = one ? zero[4 + 8 + 4 * (i / 2) + i % 2] : zero[4 + 2 + 4 * (i / 2) + i % 2];
    add_edge(w->stiff_edge + 36 * e, k, 6, r, zero, arm[one], arm[two], -1.0, 1);
    add_edge(w->mass_edge + 36 * e, crossed, 6, r, none, arm[one], arm[two], 1.0, 0);
}

/* Adds a link of a tree; tells in which lanes it is not of its plane, or not as that of the equal tree that stands for it. */
static marks assemble_plane(const Task *t, Room *w, int64_t l)
{
    const int64_t part = t->link[4 * l], *body = t->link + 4 * l + 1, e = t->link[4 * l + 3], gate = t->through[t->bodies + l];
    const int64_t model = t->model[t->bodies + l];
    const lanes *k = w->number + t->start[0] + 36 * part, *m = w->number + t->start[1] + 144 * part;
    Side *const at = w->side + l;
    const marks bad = lay(t, w, l, w->view + gate, at);
    lanes n[36], p[36], stiff[36];
    if (model != l) return bad | unlike(t, at, w->side + model);
    lie(stiff, k, 6, at, 0);
    for (int side = 0; side < 2; side++) {
        if (body[side] < 0) continue;
        const int64_t end = OWN * end_of(t, gate, body[side]);
        carried_plane(p, stiff, at->arm[side]), join_plane(w->stiff + end, p, at->arm[side], 1.0, SYMMETRIC);
        lie(n, m + 78 * side, 12, at, 0), carried_plane(p, n, at->arm[side]), join_plane(w->mass + end, p, at->arm[side], 1.0, SYMMETRIC);
    }
    if (e < 0) return bad;
    const int row = body[0] > body[1];
    if (row) lie(n, m + 6, 12, at, 1);
    else lie(n, m + 6, 12, at, 0);
    carried_plane(p, stiff, at->arm[!row]), join_plane(w->stiff_edge + 36 * e, p, at->arm[row], -1.0, PLAIN);
    carried_plane(p, n, at->arm[!row]), join_plane(w->mass_edge + 36 * e, p, at->arm[row], 1.0, PLAIN);
    return bad;
}

/* The 6x6 inertia (its lower triangle) of a body: of its mass, moments of mass (3) and moments of inertia (a lower triangle, 6). */
static INLINE void weigh(lanes *own, const lanes *n)
{
    UNROLL for (int i = 0; i < OWN; i++) own[i] = all(0.0);
    UNROLL for (int i = 0; i < 3; i++) {
        own[LOWER(i, i)] = n[0];
        own[LOWER(3 + (i + 2) % 3, (i + 1) % 3)] = n[1 + i], own[LOWER(3 + (i + 1) % 3, (i + 2) % 3)] = -n[1 + i];
        UNROLL for (int k = 0; k <= i; k++) own[LOWER(3 + i, 3 + k)] = n[4 + LOWER(i, k)];
    }
}

/* The inertia of a tree's body; tells in which lanes it is not symmetric about the plane, or not that of the equal body that stands for it. */
static marks weigh_plane(const Task *t, Room *w, int64_t b)
{
    const int64_t model = t->model[b];
    const lanes *q = w->view[t->through[b]].q, *n = w->number + t->inertia[b];
    lanes turned[10], half[9], own[OWN], *mass = w->mass + OWN * model;
    marks bad = {0};
    turned[0] = n[0];
    UNROLL for (int i = 0; i < 3; i++) turned[1 + i] = along(q, i, n + 1, 1);
    UNROLL for (int i = 0; i < 9; i++) {
        const int a = i / 3, c = i % 3;
        half[i] = n[4 + LOWER(a, 0)] * q[c] + n[4 + (a ? LOWER(a, 1) : LOWER(1, 0))] * q[3 + c] + n[4 + LOWER(2, a)] * q[6 + c];
    }
    UNROLL for (int i = 0; i < 3; i++)
        UNROLL for (int k = 0; k <= i; k++) turned[4 + LOWER(i, k)] = along(q, i, half + k, 3);
    weigh(own, turned);
    UNROLL for (int i = 0; i < 6; i++)
        UNROLL for (int k = 0; k <= i; k++) {
            const lanes x = entry(own, SPOT[i], SPOT[k], SYMMETRIC), most = t->skew * t->skew * (entry(own, SPOT[i], SPOT[i], SYMMETRIC) * entry(own, SPOT[k], SPOT[k], SYMMETRIC));
            lanes *to = mass + HALF(i / 3, i % 3, k % 3);
            if (!WITHIN(i, k)) bad |= ~(x * x <= most);
            else if (model == b) *to = x;
            else bad |= ~((x - *to) * (x - *to) <= most);
        }
    return bad;
}

static marks assemble(const Task *t, Room *w)
{
    marks bad = {0};
    const int64_t platform = OWN * (t->bodies - 1);
    memset(w->stiff, 0, sizeof(lanes) * OWN * (t->bodies + t->ports));
    memset(w->mass + OWN * t->bodies, 0, sizeof(lanes) * OWN * t->ports);
    for (int64_t v = 0; v < t->bodies; v++)
        for (int64_t e = t->range[v]; t->model[v] == v && e < t->range[v + 1]; e++)
            memset(w->stiff_edge + 36 * e, 0, sizeof(lanes) * (t->through[v] < 0 ? 36 : 18)), memset(w->mass_edge + 36 * e, 0, sizeof(lanes) * (t->through[v] < 0 ? 36 : 18));
    for (int64_t i = 0; i < w->crossings; i++) bad |= ~(w->number[w->crossing[i]] == 0.0);
    for (int64_t g = 0; g < t->gates; g++) {
        const int64_t *gate = t->gate + 6 * g;
        const lanes *r = w->number + t->start[2] + 9 * gate[1];
        View *view = w->view + g;
        for (int i = 0; i < 9; i++) view->q[i] = r[3 * (i / 3) + (gate[2] + 1 + i % 3) % 3];
        for (int i = 0; i < 3; i++) view->arm[i] = along(view->q, i, w->number + t->start[3 + gate[4]] + 3 * gate[3], 1);
    }
    for (int copies = 0; copies < 2; copies++) { /* models first */
        for (int64_t b = 0; b < t->bodies; b++)
            if ((t->model[b] != b) != copies) continue;
            else if (t->through[b] >= 0) bad |= weigh_plane(t, w, b);
            else weigh(w->mass + OWN * b, w->number + t->inertia[b]);
    }
    for (int copies = 0; copies < 2; copies++)
        for (int64_t l = 0; l < t->links; l++)
            if ((t->model[t->bodies + l] != l) != copies) continue;
            else if (t->normal[l] >= 0) bad |= assemble_plane(t, w, l);
            else assemble_whole(t, w, l);
    open_ports(t, w, w->stiff + platform, w->stiff), open_ports(t, w, w->mass + platform, w->mass);
    return bad;
}

/* ---- elimination ---- */

/* Of pivots, in each lane, how many are negative, and the least over its own entry of K. */
typedef struct { lanes negative, least; } Count;

static INLINE void count_pivots(Count *told, const lanes *pivot, const lanes *stiff, double copies, const int size)
{
    UNROLL for (int s = 0; s < size; s++) {
        const lanes ratio = size_of(pivot[s]) / stiff[LOWER(s, s)];
        told->negative += pick(pivot[s] < 0.0, all(copies), all(0.0));
        told->least = pick(ratio >= told->least, told->least, ratio);
    }
}

/* A body of a tree, and what is left of it at the later one. */
static INLINE void eliminate_tree(const Task *t, Room *w, int64_t v, lanes shift, Count *told)
{
    const int64_t e = 36 * t->range[v], o = OWN * v;
    const lanes *stiff = w->stiff + o, *mass = w->mass + o, *stiff_edge = w->stiff_edge + e, *mass_edge = w->mass_edge + e;
    lanes *own = w->other + o, *edge = w->other_edge + e, *later = w->other + OWN * t->later[t->range[v]];
    const int64_t before = t->nth[2 * v], nth = t->nth[2 * v + 1];
    UNROLL for (int h = 0; h < 2; h++) {
        lanes a[6], x[9], pivot[3], left[6];
        UNROLL for (int i = 0; i < 6; i++) a[i] = stiff[6 * h + i] - shift * mass[6 * h + i];
        if (before)
            UNROLL for (int i = 0; i < 6; i++) a[i] += own[6 * h + i];
        invert(a, pivot, 3);
        if (told) count_pivots(told, pivot, stiff + 6 * h, (double)t->copies[v], 3);
        UNROLL for (int i = 0; i < 9; i++) x[i] = stiff_edge[9 * h + i] - shift * mass_edge[9 * h + i];
        UNROLL for (int c = 0; c < 3; c++) x[3 + c] -= a[1] * x[c];
        UNROLL for (int c = 0; c < 3; c++) x[6 + c] -= a[3] * x[c] + a[4] * x[3 + c];
        UNROLL for (int i = 0; i < 6; i++) left[i] = all(0.0);
        UNROLL for (int r = 0; r < 3; r++)
            UNROLL for (int i = 0; i < 3; i++) {
                const lanes scaled = x[3 * r + i] * a[LOWER(r, r)];
                UNROLL for (int k = 0; k <= i; k++) left[LOWER(i, k)] -= scaled * x[3 * r + k];
            }
        UNROLL for (int i = 0; i < 6; i++) own[6 * h + i] = a[i];
        UNROLL for (int i = 0; i < 9; i++) edge[9 * h + i] = x[i];
        if (nth)
            UNROLL for (int i = 0; i < 6; i++) later[6 * h + i] += left[i];
        else
            UNROLL for (int i = 0; i < 6; i++) later[6 * h + i] = left[i];
    }
}

/* A product of two edges of body v, which elimination subtracts from what is between later bodies. */
static INLINE void join_update(Room *w, int64_t v, const int64_t *edges)
{
    const lanes *own = w->other + OWN * v, *x = w->other_edge + 36 * edges[0], *y = w->other_edge + 36 * edges[1];
    for (int c = 0; c < 6; c++) {
        lanes scaled[6];
        UNROLL for (int i = 0; i < 6; i++) scaled[i] = own[LOWER(i, i)] * y[6 * i + c];
        multiply(w->other_edge + 36 * edges[2] + c, x, scaled, 6, TURNED, 1, 1);
    }
}

/* Another body: of its own block K - shift M, less what bodies before it left, is at hand. */
static INLINE void eliminate_whole(const Task *t, Room *w, int64_t v, lanes shift, Count *told)
{
    lanes pivot[6], *own = w->other + OWN * v;
    invert(own, pivot, 6);
    if (told) count_pivots(told, pivot, w->stiff + OWN * v, 1.0, 6);
    for (int64_t e = t->range[v]; e < t->range[v + 1]; e++) reduce(w->other_edge + 36 * e, w->stiff_edge + 36 * e, w->mass_edge + 36 * e, shift, own, w->fills);
    for (int64_t u = t->product[v]; u < t->product[v + 1]; u++) {
        lanes *later = w->other + OWN * t->later[t->update[3 * u]];
        const lanes *x = w->other_edge + 36 * t->update[3 * u];
        if (t->update[3 * u + 2] >= 0) join_update(w, v, t->update + 3 * u);
        else update(later, x, own, 3), update(later, x, own, 0);
    }
}

/* The bodies that are in no tree, the platform last. */
static INLINE void eliminate_rest(const Task *t, Room *w, lanes shift, Count *told)
{
    for (int64_t v = 0; v < t->bodies; v++)
        for (int i = 0; i < OWN && t->through[v] < 0; i++) w->other[OWN * v + i] = w->stiff[OWN * v + i] - shift * w->mass[OWN * v + i];
    if (w->fills)
        for (int64_t i = 0; i < 36 * t->edges; i++) w->other_edge[i] = w->stiff_edge[i] - shift * w->mass_edge[i];
    for (int64_t v = 0; v < t->bodies; v++) {
        if (t->through[v] >= 0) continue;
        if (v == t->bodies - 1) open_ports(t, w, w->other + OWN * v, w->other);
        eliminate_whole(t, w, v, shift, told);
    }
}

/* w->other, w->other_edge = K - shift M = L D L^T: own blocks as `invert` leaves them, edges L^-1 times themselves; what is told of pivots. */
static void eliminate(const Task *t, Room *w, lanes shift, Count *told)
{
    for (int64_t i = 0; i < t->tree[t->ports]; i++) eliminate_tree(t, w, t->member[i], shift, told);
    eliminate_rest(t, w, shift, told);
}

/* Columns of a body or port: those of all its copies. */
#define ROWS(x, v) ((x) + t->row[v] * m + j)

/* A tree's body forward, n of `wide` columns: of x = (K - shift M)^-1 f, what is not there yet is taken from f, nothing from ports. */
static INLINE void forward_tree(const Task *t, const Room *w, lanes *x, const lanes *f, int64_t v, int m, const int wide, int j, const int n)
{
    const int64_t last = t->later[t->range[v]];
    const lanes *restrict a = w->other + OWN * v, *restrict e = w->other_edge + 36 * t->range[v];
    const int fresh = !t->nth[2 * v + 1], port = last >= t->bodies;
    lanes *own = ROWS(x, v), *later = ROWS(x, last);
    const lanes *from = t->nth[2 * v] ? own : ROWS(f, v), *to = fresh && !port ? ROWS(f, last) : later;
    UNROLL for (int h = 0; h < 2; h++) {
        lanes u[12], s[12];
        UNROLL for (int i = 0; i < 3; i++)
            UNROLL for (int k = 0; k < n; k++) u[i * n + k] = from[(3 * h + i) * wide + k], s[i * n + k] = fresh && port ? all(0.0) : to[(3 * h + i) * wide + k];
        UNROLL for (int k = 0; k < n; k++) {
            u[n + k] -= a[6 * h + 1] * u[k];
            u[2 * n + k] -= a[6 * h + 3] * u[k];
            u[2 * n + k] -= a[6 * h + 4] * u[n + k];
        }
        UNROLL for (int i = 0; i < 3; i++)
            UNROLL for (int k = 0; k < n; k++) u[i * n + k] *= a[HALF(h, i, i)];
        UNROLL for (int i = 0; i < 3; i++)
            UNROLL for (int c = 0; c < 3; c++)
                UNROLL for (int k = 0; k < n; k++) s[c * n + k] -= e[9 * h + 3 * i + c] * u[i * n + k];
        UNROLL for (int i = 0; i < 3; i++)
            UNROLL for (int k = 0; k < n; k++) own[(3 * h + i) * wide + k] = u[i * n + k], later[(3 * h + i) * wide + k] = s[i * n + k];
    }
}

/* The same backward, and what the body adds to y = M x. */
static INLINE void backward_tree(const Task *t, const Room *w, lanes *x, lanes *y, int64_t v, int m, const int wide, int j, const int n)
{
    const int64_t at = t->range[v], last = t->later[at];
    const lanes *restrict a = w->other + OWN * v, *restrict e = w->other_edge + 36 * at, *restrict g = w->mass + OWN * v, *restrict f = w->mass_edge + 36 * at;
    const int fresh = last >= t->bodies && t->nth[2 * v + 1] + 1 == t->nth[2 * last];
    lanes *own = ROWS(x, v), *later = ROWS(x, last), *force = ROWS(y, v), *on = ROWS(y, last);
    UNROLL for (int h = 0; h < 2; h++) {
        lanes u[12], s[12], p[12];
        UNROLL for (int i = 0; i < 3; i++)
            UNROLL for (int k = 0; k < n; k++) {
                p[i * n + k] = later[(3 * h + i) * wide + k];
                s[i * n + k] = all(0.0);
            }
        UNROLL for (int i = 0; i < 3; i++)
            UNROLL for (int c = 0; c < 3; c++)
                UNROLL for (int k = 0; k < n; k++) s[i * n + k] += e[9 * h + 3 * i + c] * p[c * n + k];
        UNROLL for (int i = 0; i < 3; i++) /* D^-1 has been applied: here to what the edge adds, too */
            UNROLL for (int k = 0; k < n; k++) u[i * n + k] = own[(3 * h + i) * wide + k] - a[HALF(h, i, i)] * s[i * n + k];
        UNROLL for (int k = 0; k < n; k++) {
            u[n + k] -= a[6 * h + 4] * u[2 * n + k];
            u[k] -= a[6 * h + 3] * u[2 * n + k];
            u[k] -= a[6 * h + 1] * u[n + k];
        }
        UNROLL for (int i = 0; i < 3; i++)
            UNROLL for (int k = 0; k < n; k++) own[(3 * h + i) * wide + k] = u[i * n + k], s[i * n + k] = all(0.0);
        UNROLL for (int i = 0; i < 3; i++)
            UNROLL for (int c = 0; c < 3; c++)
                UNROLL for (int k = 0; k < n; k++) s[i * n + k] += g[i > c ? HALF(h, i, c) : HALF(h, c, i)] * u[c * n + k];
        UNROLL for (int c = 0; c < 3; c++) {
            lanes more[4];
            UNROLL for (int k = 0; k < n; k++) more[k] = fresh ? all(0.0) : on[(3 * h + c) * wide + k];
            UNROLL for (int i = 0; i < 3; i++)
                UNROLL for (int k = 0; k < n; k++) {
                    s[i * n + k] += f[9 * h + 3 * i + c] * p[c * n + k];
                    more[k] += f[9 * h + 3 * i + c] * u[i * n + k];
                }
            UNROLL for (int k = 0; k < n; k++) on[(3 * h + c) * wide + k] = more[k];
        }
        UNROLL for (int i = 0; i < 3; i++)
            UNROLL for (int k = 0; k < n; k++) force[(3 * h + i) * wide + k] = s[i * n + k];
    }
}

/* Another body's n of m columns. */
static INLINE void forward_whole(const Task *t, const Room *w, lanes *x, int64_t v, int m, int j, const int n)
{
    const lanes *a = w->other + OWN * v;
    lanes u[24], *own = ROWS(x, v);
    pick_columns(u, own, m, n);
    lower(u, a, n);
    UNROLL for (int i = 0; i < 6; i++)
        UNROLL for (int k = 0; k < n; k++) own[i * m + k] = u[i * n + k] *= a[LOWER(i, i)];
    for (int64_t e = t->range[v]; e < t->range[v + 1]; e++) multiply(ROWS(x, t->later[e]), w->other_edge + 36 * e, u, m, TURNED, 1, n);
}

static INLINE void backward_whole(const Task *t, const Room *w, lanes *x, lanes *y, int64_t v, int m, int j, const int n)
{
    const lanes *a = w->other + OWN * v;
    lanes u[24], *own = ROWS(x, v), *force = ROWS(y, v);
    for (int64_t e = t->range[v]; e < t->range[v + 1]; e++) {
        lanes sum[24];
        pick_columns(u, ROWS(x, t->later[e]), m, n);
        UNROLL for (int i = 0; i < 6 * n; i++) sum[i] = all(0.0);
        multiply(sum, w->other_edge + 36 * e, u, n, PLAIN, 0, n);
        UNROLL for (int i = 0; i < 6; i++)
            UNROLL for (int k = 0; k < n; k++) own[i * m + k] -= a[LOWER(i, i)] * sum[i * n + k];
    }
    pick_columns(u, own, m, n);
    upper(u, a, n);
    UNROLL for (int i = 0; i < 6; i++)
        UNROLL for (int k = 0; k < n; k++) own[i * m + k] = u[i * n + k], force[i * m + k] = all(0.0);
    multiply(force, w->mass + OWN * v, u, m, SYMMETRIC, 0, n);
    for (int64_t e = t->range[v]; e < t->range[v + 1]; e++)
        if (t->heavy[e]) {
            lanes other[24];
            pick_columns(other, ROWS(x, t->later[e]), m, n);
            multiply(ROWS(y, t->later[e]), w->mass_edge + 36 * e, u, m, TURNED, 0, n);
            multiply(force, w->mass_edge + 36 * e, other, m, PLAIN, 0, n);
        }
}

/* Where a gate's columns stand among those of its port. */
static INLINE lanes *columns_of(const Task *t, lanes *x, int64_t gate, int m)
{
    const int j = (int)t->gate[6 * gate + 5] * m;
    return ROWS(x, t->bodies + t->gate[6 * gate]);
}

/* The ports' rows as the platform moves, in m columns. */
static INLINE void enter_ports(const Task *t, const Room *w, lanes *x, const int m)
{
    const lanes *from = x + t->row[t->bodies - 1] * m;
    for (int64_t g = 0; g < t->gates; g++) {
        const int64_t wide = t->copies[t->bodies + t->gate[6 * g]] * m;
        const lanes *q = w->view[g].q, *arm = w->view[g].arm;
        lanes *to = columns_of(t, x, g, m);
        for (int c = 0; c < m; c++) {
            lanes u[6];
            UNROLL for (int i = 0; i < 6; i++)
                u[i] = q[i % 3] * from[(i - i % 3) * m + c] + q[3 + i % 3] * from[(i - i % 3 + 1) * m + c] + q[6 + i % 3] * from[(i - i % 3 + 2) * m + c];
            to[c] = u[0] + arm[1] * u[5] - arm[2] * u[4], to[wide + c] = u[1] + arm[2] * u[3] - arm[0] * u[5], to[2 * wide + c] = u[5];
            to[3 * wide + c] = u[2] + arm[0] * u[4] - arm[1] * u[3], to[4 * wide + c] = u[3], to[5 * wide + c] = u[4];
        }
    }
}

/* The platform's forces += those on the ports. */
static INLINE void leave_ports(const Task *t, const Room *w, lanes *y, const int m)
{
    lanes *to = y + t->row[t->bodies - 1] * m;
    for (int c = 0; c < m; c++) {
        lanes sum[6];
        UNROLL for (int i = 0; i < 6; i++) sum[i] = to[i * m + c];
        for (int64_t g = 0; g < t->gates; g++) {
            const int64_t wide = t->copies[t->bodies + t->gate[6 * g]] * m;
            const lanes *q = w->view[g].q, *arm = w->view[g].arm, *from = columns_of(t, y, g, m) + c;
            const lanes one = from[0], two = from[wide], three = from[3 * wide];
            const lanes f[6] = {one, two, three, from[4 * wide] + arm[2] * two - arm[1] * three, from[5 * wide] + arm[0] * three - arm[2] * one,
                                from[2 * wide] + arm[1] * one - arm[0] * two};
            UNROLL for (int i = 0; i < 6; i++) sum[i] += q[3 * (i % 3)] * f[i - i % 3] + q[3 * (i % 3) + 1] * f[i - i % 3 + 1] + q[3 * (i % 3) + 2] * f[i - i % 3 + 2];
        }
        UNROLL for (int i = 0; i < 6; i++) to[i * m + c] = sum[i];
    }
}

/* A tree forward, eliminated before where there is a shift: what it works on is then at hand. */
static INLINE void descend(const Task *t, Room *w, lanes *x, const lanes *f, int64_t port, const lanes *shift, const int m)
{
    for (int64_t i = t->tree[port]; shift && i < t->tree[port + 1]; i++) eliminate_tree(t, w, t->member[i], *shift, 0);
    for (int64_t i = t->tree[port]; i < t->tree[port + 1]; i++) {
        const int64_t v = t->member[i];
        IN_COLUMNS((int)t->copies[v] * m, forward_tree(t, w, x, f, v, m, wide, j, n))
    }
}

/* And back, where the ports' motions are known. */
static INLINE void ascend(const Task *t, const Room *w, lanes *x, lanes *y, int64_t port, const int m)
{
    for (int64_t i = t->tree[port + 1] - 1; i >= t->tree[port]; i--) {
        const int64_t v = t->member[i];
        IN_COLUMNS((int)t->copies[v] * m, backward_tree(t, w, x, y, v, m, wide, j, n))
    }
}

/* Of x and y = M x what is in no tree, and the ports' motions, where all trees have descended. */
static INLINE void turn_back(const Task *t, const Room *w, lanes *x, const lanes *f, lanes *y, const int m)
{
    const int wide = m;
    for (int64_t v = 0; v < t->bodies; v++)
        for (int64_t i = t->row[v] * m; t->through[v] < 0 && i < (t->row[v] + 6) * m; i++) x[i] = f[i];
    leave_ports(t, w, x, m);
    for (int64_t v = 0; v < t->bodies; v++)
        if (t->through[v] < 0) IN_THREES(forward_whole(t, w, x, v, m, j, n))
    for (int64_t v = t->bodies - 1; v >= 0; v--)
        if (t->through[v] < 0) IN_THREES(backward_whole(t, w, x, y, v, m, j, n))
    enter_ports(t, w, x, m);
}

/* x = (K - shift M)^-1 f, m vectors, eliminated for it, and y = M x. */
static INLINE void solve(const Task *t, Room *w, lanes *x, const lanes *f, lanes *y, lanes shift, const int m)
{
    for (int64_t port = 0; port < t->ports; port++) descend(t, w, x, f, port, &shift, m);
    eliminate_rest(t, w, shift, 0);
    turn_back(t, w, x, f, y, m);
    for (int64_t port = 0; port < t->ports; port++) ascend(t, w, x, y, port, m);
    leave_ports(t, w, y, m);
}

/* Dots of vectors x, f and y = M x: x M x of the step before, x f and x y. */
typedef struct { lanes before, between, after; } Dots;

static INLINE void add_dots(Dots *to, const lanes *x, const lanes *f, const lanes *y, int64_t rows)
{
    lanes sum[4] = {all(0.0), all(0.0), all(0.0), all(0.0)};
    for (int64_t i = 0; i < rows; i += 2) /* rows are even */
        UNROLL for (int k = 0; k < 2; k++) sum[k] += x[i + k] * f[i + k], sum[2 + k] += x[i + k] * y[i + k];
    to->between += sum[0] + sum[1], to->after += sum[2] + sum[3];
}

/* Steps of inverse iteration of one vector x: y = M x and f = M times it before, in turn. A tree that came back goes on at once, as its
 * matrices are at hand. */
static INLINE Dots iterate(const Task *t, Room *w, lanes *x, lanes *f, lanes *y, lanes shift, int steps)
{
    Dots dots = {all(0.0), all(0.0), all(1.0)};
    for (int64_t port = 0; port < t->ports; port++) descend(t, w, x, f, port, &shift, 1);
    eliminate_rest(t, w, shift, 0);
    for (int step = 1; step <= steps; step++) {
        dots = (Dots){dots.after, all(0.0), all(0.0)};
        turn_back(t, w, x, f, y, 1);
        for (int64_t port = 0; port < t->ports; port++) {
            ascend(t, w, x, y, port, 1);
            for (int64_t i = t->tree[port]; i < t->tree[port + 1]; i++) {
                const int64_t row = t->row[t->member[i]];
                add_dots(&dots, x + row, f + row, y + row, 6 * t->copies[t->member[i]]);
            }
            if (step < steps) descend(t, w, x, y, port, 0, 1);
        }
        leave_ports(t, w, y, 1);
        for (int64_t v = 0; v < t->bodies; v++)
            if (t->through[v] < 0) add_dots(&dots, x + t->row[v], f + t->row[v], y + t->row[v], 6);
        lanes *const other = f;
        f = y, y = other;
    }
    return dots;
}

/* ---- Rayleigh-Ritz ---- */

/* Entry (r, i) of m vectors: they stand side by side (row m, column 1) or one after the other (row 1, column n). */
typedef struct { int64_t row, column; } Layout;

/* Dots of ni vectors x from i0 on with nj of y and of z from j0 on, or (`half`) the lower half of them; z is the same in all lanes where it is `plain`. */
static INLINE void dots(
    int64_t n, int m, Layout at, lanes *g, lanes *h, const lanes *x, const lanes *y, const lanes *z, const double *plain, int i0, int j0, const int ni, const int nj, const int half)
{
    lanes s[9], u[9];
    UNROLL for (int k = 0; k < 9; k++) s[k] = u[k] = all(0.0);
    for (int64_t r = 0; r < n; r++)
        UNROLL for (int i = 0; i < ni; i++) {
            const lanes own = x[r * at.row + (i0 + i) * at.column];
            UNROLL for (int j = 0; j < nj; j++) {
                if (half && j > i) continue;
                const int64_t place = r * at.row + (j0 + j) * at.column;
                s[3 * i + j] += own * y[place];
                if (plain) u[3 * i + j] += own * plain[place];
                else u[3 * i + j] += own * z[place];
            }
        }
    UNROLL for (int i = 0; i < ni; i++)
        UNROLL for (int j = 0; j < nj; j++) {
            if (half && j > i) continue;
            g[(i0 + i) * m + j0 + j] = g[(j0 + j) * m + i0 + i] = s[3 * i + j];
            h[(i0 + i) * m + j0 + j] = h[(j0 + j) * m + i0 + i] = u[3 * i + j];
        }
}

/* g and h (m x m, lower triangles and their mirrors) = x^T y and x^T z, known to be symmetric. */
static INLINE void grams(int64_t n, int m, Layout at, lanes *g, lanes *h, const lanes *x, const lanes *y, const lanes *z, const double *plain)
{
    for (int i = 0; i < m; i += 3)
        for (int j = 0; j <= i; j += 3) {
            const int rows = m - i;
            if (rows > 2) j < i ? dots(n, m, at, g, h, x, y, z, plain, i, j, 3, 3, 0) : dots(n, m, at, g, h, x, y, z, plain, i, j, 3, 3, 1);
            else if (rows == 2) j < i ? dots(n, m, at, g, h, x, y, z, plain, i, j, 2, 3, 0) : dots(n, m, at, g, h, x, y, z, plain, i, j, 2, 2, 1);
            else j < i ? dots(n, m, at, g, h, x, y, z, plain, i, j, 1, 3, 0) : dots(n, m, at, g, h, x, y, z, plain, i, j, 1, 1, 1);
        }
}

static INLINE void blends(int64_t n, int m, Layout at, int64_t next, lanes *y, const lanes *x, const lanes *q, int c, const int ni)
{
    for (int64_t r = 0; r < n; r += 2) { /* n is even */
        lanes s[6];
        for (int k = 0; k < 6; k++) s[k] = all(0.0);
        for (int k = 0; k < m; k++)
            for (int i = 0; i < ni; i++) {
                s[i] += x[r * at.row + k * at.column] * q[k * m + c + i];
                s[3 + i] += x[(r + 1) * at.row + k * at.column] * q[k * m + c + i];
            }
        for (int i = 0; i < ni; i++) y[(c + i) * next + r] = s[i], y[(c + i) * next + r + 1] = s[3 + i];
    }
}

/* y = x q, the columns of it from c to before `count`, one after the other, each `next` further on. */
static INLINE void blend(int64_t n, int m, Layout at, int64_t next, lanes *restrict y, const lanes *restrict x, const lanes *restrict q, int c, int count)
{
    for (; c + 3 <= count; c += 3) blends(n, m, at, next, y, x, q, c, 3);
    if (count - c == 2) blends(n, m, at, next, y, x, q, c, 2);
    else if (count - c == 1) blends(n, m, at, next, y, x, q, c, 1);
}

/* Eigenvalues on the diagonal of a and vectors in v (columns), by Jacobi's rotations; those of a lane stop when they are done. */
static INLINE void jacobi(const int m, lanes *a, lanes *v, double least)
{
    for (int i = 0; i < m * m; i++) v[i] = all(i % (m + 1) ? 0.0 : 1.0);
    for (int sweep = 0; sweep < 20; sweep++) {
        int moved = 0;
        for (int p = 0; p < m - 1; p++)
            for (int q = p + 1; q < m; q++) {
                const lanes o = a[p * m + q], d = a[p * m + p], e = a[q * m + q];
                const marks turn = o * o > least * least * size_of(d * e);
                if (!any(turn)) continue;
                moved = 1;
                const lanes two = pick(turn, o + o, all(0.0)), apart = e - d, far = root(apart * apart + two * two);
                const lanes t = pick(turn, two / pick(apart < 0.0, apart - far, apart + far), all(0.0)); /* tangent of the angle that makes o nought */
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
static INLINE void small(const int m, lanes *stiff, lanes *mass, lanes *values, lanes *q, double least)
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
    marks other = {0}; /* lanes in which they are not in order */
    for (int c = 0; c < m; c++) {
        values[c] = stiff[c * (m + 1)];
        if (c) other |= ~(values[c - 1] <= values[c]);
        for (int i = 0; i < m; i++) q[i * m + c] = scale[i] * turned[i * m + c];
    }
    for (int lane = 0; lane < WIDTH; lane++) {
        if (!other[lane]) continue;
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
 * how much of each is in each of the modes, and the modes' participation in the platform's compliance. */
typedef struct { lanes values[MOST], share[MOST], shift[MOST], quotient[MOST], sine[MOST], part[MOST * MOST], mix[MOST * MOST], gain[MOST * 6]; } Ritz;

/* Whether mode c takes one step, of modes told by bits. */
#define ONCE(once, c) ((once) >> (c) & 1)

/* The share of the platform in mode c of x q, x the platform's rows. */
static lanes share_of(const Task *t, const Room *w, const lanes *x, const lanes *q, int m, int c)
{
    lanes seen[6], platform[OWN], sum = all(0.0);
    weigh(platform, w->number + t->inertia[t->bodies - 1]);
    for (int i = 0; i < 6; i++) {
        seen[i] = x[i * m] * q[c];
        for (int k = 1; k < m; k++) seen[i] += x[i * m + k] * q[k * m + c];
    }
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < 6; k++) sum += seen[i] * entry(platform, i, k, SYMMETRIC) * seen[k];
    return sum;
}

/* Rayleigh-Ritz on (K - shift M)^-1 times the forces to begin with: all values, and M times the modes that are wanted, where `polish` takes them. */
static INLINE void begin(const Task *t, Room *w, Ritz *out, const int m, const int single)
{
    const int64_t n = 6 * t->bodies;
    lanes stiff[MOST * MOST], mass[MOST * MOST], q[MOST * MOST];
    solve(t, w, w->ahead, w->start, w->now, all(t->shift), m);
    grams(n, m, (Layout){m, 1}, mass, stiff, w->ahead, w->now, 0, t->force);
    for (int i = 0; i < m * m; i++) stiff[i] += t->shift * mass[i];
    small(m, stiff, mass, out->values, q, 1e-6);
    for (int c = 0; c < m; c++) out->share[c] = share_of(t, w, w->ahead + (n - 6) * m, q, m, c);
    for (int c = 0, end; c < single; c = end) {
        for (end = c + 1; end < single && ONCE(t->once, end) == ONCE(t->once, c); end++) {}
        blend(n, m, (Layout){m, 1}, t->rows, ONCE(t->once, c) ? w->next : w->force, w->now, q, c, end);
    }
}

/* Rayleigh-Ritz on single modes in w->ahead: shapes in w->now; M times them are in w->force, M times what they were made of in w->next. */
static INLINE void combine(const Task *t, Room *w, Ritz *known, const int m)
{
    const int64_t n = 6 * t->bodies;
    const Layout at = {1, t->rows};
    lanes stiff[MOST * MOST], mass[MOST * MOST], length[MOST];
    grams(n, m, at, mass, stiff, w->ahead, w->force, w->next, 0);
    for (int i = 0; i < m; i++)
        for (int j = 0; j <= i; j++) stiff[i * m + j] = stiff[j * m + i] = known->shift[j] * mass[i * m + j] + stiff[i * m + j];
    for (int i = 0; i < m; i++) length[i] = root(mass[i * m + i]);
    small(m, stiff, mass, known->values, known->mix, ROUNDING);
    blend(n, m, at, t->rows, w->now, w->ahead, known->mix, 0, m);
    for (int c = 0; c < m; c++) {
        for (int k = 0; k < m; k++) known->part[c * m + k] = size_of(known->mix[k * m + c]) * length[k];
        lanes one = all(1.0), seen[6];
        for (int i = 0; i < 6; i++) seen[i] = w->now[c * t->rows + n - 6 + i];
        known->share[c] = share_of(t, w, seen, &one, 1, 0);
        for (int i = 0; i < 6; i++) {
            lanes sum = seen[i];
            for (int k = i + 1; k < 6; k++) sum += w->root[LOWER(k, i)] * seen[k];
            known->gain[6 * c + i] = sum / root(w->root[LOWER(i, i)] * known->values[c]);
        }
    }
}

/* The wanted modes one by one, by steps of inverse iteration with a shift just below each value, and Rayleigh-Ritz on them: to shapes (single, rows)
 * in w->now. What is of other modes falls in each step like the value's distance from the shift over theirs: those that do with one begin with M times
 * them in w->next, others in w->force. */
static void polish(const Task *t, Room *w, Ritz *known, int64_t once)
{
    const int m = (int)t->single;
    for (int c = 0; c < m; c++) {
        lanes *const x = w->ahead + c * t->rows, *const one = w->force + c * t->rows, *const two = w->next + c * t->rows;
        const int single = (int)ONCE(once, c);
        known->shift[c] = (1.0 - BESIDE) * known->values[c];
        const Dots dots = iterate(t, w, x, single ? two : one, single ? one : two, known->shift[c], single ? 1 : 2);
        const lanes square = 1.0 - dots.between * dots.between / (dots.before * dots.after);
        known->sine[c] = root(pick(square > 0.0, square, all(0.0)));
        known->sine[c] = pick(square == square, known->sine[c], square);
        known->quotient[c] = dots.between / dots.before;
    }
    if (m == USUAL) combine(t, w, known, USUAL);
    else combine(t, w, known, m);
}

/* ---- which modes are the platform's, one design at a time ---- */

typedef struct { int done, below, mask[MOST]; double shift; } Verdict;

static int apart(const double *values, int m, int needed, double together)
{
    while (needed < m && values[needed] - values[needed - 1] <= together * values[needed]) needed++;
    return needed;
}

/* Whether one more eigenvalue of H exceeds a threshold with a mode of participation g: whether det(H - threshold I) changes its sign. `inverse` is that of
 * H - threshold I, and will be with the mode. */
static int exceeds(double *inverse, const double *g)
{
    double moved[6], ratio = 1.0;
    for (int i = 0; i < 6; i++) {
        moved[i] = 0.0;
        for (int k = 0; k < 6; k++) moved[i] += inverse[6 * i + k] * g[k];
        ratio += g[i] * moved[i];
    }
    for (int i = 0; i < 36; i++) inverse[i] -= moved[i / 6] * moved[i % 6] / ratio;
    return ratio < 0.0;
}

static void judge(const Task *t, const Ritz *known, int lane, Verdict *out)
{
    const int m = (int)t->m, count = (int)t->count, single = (int)t->single;
    double value[MOST + 1], frequency[MOST], less[36], more[36];
    int taken = 0, needed = 0;
    memset(out, 0, sizeof *out);
    for (int i = 0; i < m; i++) {
        value[i] = known->values[i][lane];
        if (!isfinite(value[i]) || value[i] <= 0.0) return;
        frequency[i] = sqrt(value[i]) / (2.0 * 3.14159265358979323846);
    }
    for (int i = 0; i < 36; i++) {
        less[i] = i % 7 ? 0.0 : -1.0 / (t->threshold - t->margin);
        more[i] = i % 7 ? 0.0 : -1.0 / (t->threshold + t->margin);
    }
    for (int i = 0, end; i < single && taken < count; i = end) { /* cluster by cluster */
        int gained = 0, sure = 0;
        for (end = i; end < single && (end == i || frequency[end] - frequency[end - 1] <= t->cluster * frequency[end]); end++) {
            double g[6];
            for (int k = 0; k < 6; k++) g[k] = known->gain[6 * end + k][lane];
            gained += exceeds(less, g), sure += exceeds(more, g);
        }
        if (gained != sure || (gained && gained != end - i)) return;
        for (int k = i; k < end; k++) out->mask[k] = gained > 0;
        if (gained) taken += gained, needed = end;
    }
    int first = single;
    while (first > needed && apart(value, m, first, t->together) != first) first--;
    if (taken != count || needed > first || apart(value, m, first, t->together) != first) return;
    if (first == m) value[m] = value[m - 1] * (1.0 + 10.0 * ABOVE); /* no value beyond is at hand: that there is none up to a little above these is counted */
    out->below = first, out->shift = value[first - 1] + 0.1 * (value[first] - value[first - 1]);
    /* What of a single vector is of modes beyond: it has gone through (K - shift M)^-1 M, whose values there are 1 / (outer - shift) at most. */
    const double outer = out->shift;
    double beyond[MOST];
    for (int k = 0; k < single; k++) {
        const double far = (outer - known->shift[k][lane]) * fabs(known->quotient[k][lane]) - 1.0;
        beyond[k] = k < first && far > known->sine[k][lane] ? known->sine[k][lane] / far : 1.0;
    }
    for (int i = 0; i < needed; i++) {
        double angle = 0.0;
        for (int k = 0; k < single; k++) angle += known->part[i * single + k][lane] * beyond[k];
        if (!(angle * angle * outer / value[i] <= t->value) || (out->mask[i] && !(angle <= t->angle))) return;
    }
    out->done = value[0] > BESIDE * value[first - 1];
}

/* ---- derivatives ---- */

enum { STIFFNESS, MASS, FIRST_TURN, FIRST, SECOND_TURN, SECOND, INERTIA }; /* turns of a link's axes as its bodies see them, and its arms */

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
        EACH_MODE for (int p = 0; p < k; p++) sum[p] = more ? sum[p] + factor * a[p] * b[p] : factor * a[p] * b[p];
}

/* out (k) = the entries of a row of a law times x (k columns). */
static INLINE void weigh_row(lanes *out, const lanes *row, const int *column, int entries, const lanes *x, const int k)
{
    lanes sum[MODES];
    for (int c = 0; c < MODES; c++) sum[c] = all(0.0);
    for (int at = 0; at < entries; at++) {
        const lanes own = row[column[at]], *y = x + column[at] * k;
        EACH_MODE for (int c = 0; c < k; c++) sum[c] += own * y[c];
    }
    EACH_MODE for (int c = 0; c < k; c++) out[c] = sum[c];
}

/* A link in the modes: twists of its ends in its axes (12, k), strains (6, k), motions of its place as either body moves it (3, k each) in the stage's
 * axes, forces less lambda times momenta on its ends (12, k), the same in the stage's axes. */
typedef struct { lanes twist[12 * MODES], strain[6 * MODES], seen[6 * MODES], force[12 * MODES], world[12 * MODES], pull[MODES]; } Moved;

static INLINE void move_link(const Task *t, const Room *w, int64_t l, Moved *to, const int k)
{
    const lanes *r = w->number + t->start[2] + 9 * l;
    for (int side = 0; side < 2; side++) {
        const int64_t body = t->link[4 * l + 1 + side];
        lanes *e = to->twist + 6 * side * k, *u = to->seen + 3 * side * k;
        if (body < 0) {
            memset(e, 0, sizeof(lanes) * 6 * k);
            continue;
        }
        const lanes *a = w->number + t->start[3 + side] + 3 * l, *x = w->placed + 6 * k * body, *o = x + 3 * k;
        EACH_MODE for (int c = 0; c < k; c++) {
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
        EACH_MODE for (int c = 0; c < k; c++) to->strain[i * k + c] = to->twist[(6 + i) * k + c] - to->twist[i * k + c];
}

/* At the ends that slots about a link's place are of. `turned`: moments too, which only axes feel. */
static INLINE void load_link(const Task *t, const Room *w, int64_t l, Moved *to, const lanes *mean, const int turned, const int k)
{
    const int64_t *slots = t->slot + 5 * t->reach[t->parts + l], *end = t->slot + 5 * t->reach[t->parts + l + 1];
    const int first = slots[0] > FIRST, last = end[-5] > FIRST ? 2 : 1; /* they are in the order of their kinds */
    const lanes *r = w->number + t->start[2] + 9 * l, *stiff = w->number + t->start[0] + 36 * t->link[4 * l];
    const lanes *mass = w->number + t->start[1] + 144 * t->link[4 * l];
    const Law *law = w->law + t->link[4 * l];
    for (int i = 0; i < (turned ? 6 : 3); i++) {
        lanes *const pull = to->pull;
        weigh_row(pull, stiff + 6 * i, law->column + law->start[i], law->start[i + 1] - law->start[i], to->strain, k);
        for (int side = first; side < last; side++) {
            const int row = 6 * side + i;
            lanes *const f = to->force + row * k;
            const double sign = side ? 1.0 : -1.0;
            weigh_row(f, mass + 12 * row, law->column + law->start[6 + row], law->start[7 + row] - law->start[6 + row], to->twist, k);
            EACH_MODE for (int c = 0; c < k; c++) f[c] = sign * pull[c] - mean[c] * f[c];
        }
    }
    for (int side = first; side < last; side++)
        for (int i = 0; i < (turned ? 6 : 3); i++) {
            const lanes *f = to->force + (6 * side + i - i % 3) * k, *q = r + 3 * (i % 3);
            EACH_MODE for (int c = 0; c < k; c++) to->world[(6 * side + i) * k + c] = q[0] * f[c] + q[1] * f[k + c] + q[2] * f[2 * k + c];
        }
}

/* Adds a link's share of every slot of its part to `sum`. */
static INLINE void law_slots(const Task *t, int64_t l, const Moved *at, lanes *sum, const Wanted *of, const int crossed, const int k, const int n)
{
    const int64_t part = t->link[4 * l];
    const int least = t->link[4 * l + 1] < 0 ? 6 : 0, most = t->link[4 * l + 2] < 0 ? 6 : 12;
    for (int64_t s = t->reach[part]; s < t->reach[part + 1]; s++, sum += n) {
        const int row = (int)t->slot[5 * s + 2], column = (int)t->slot[5 * s + 3], one = (row + 6) % 12, two = (column + 6) % 12;
        const double factor = row == column ? 1.0 : 2.0, other = (double)t->slot[5 * s + 4] * factor;
        const lanes *x = at->twist + row * k, *y = at->twist + column * k;
        if (t->slot[5 * s] == STIFFNESS) {
            gain(sum, at->strain + row * k, at->strain + column * k, factor, 1, of, crossed, k);
            continue;
        }
        const int own = row >= least && column < most, mirrored = other != 0.0 && one >= least && two >= least && one < most && two < most;
        const lanes *u = at->twist + one * k, *v = at->twist + two * k;
        if (own && mirrored && !crossed)
            EACH_MODE for (int p = 0; p < k; p++) sum[p] += factor * x[p] * y[p] + other * u[p] * v[p];
        else {
            if (own) gain(sum, x, y, factor, 1, of, crossed, k);
            if (mirrored) gain(sum, u, v, other, 1, of, crossed, k);
        }
    }
}

/* sum += or = factor times entry `at` of the product a x b of two vectors (3, k). */
static INLINE void gain_product(lanes *sum, const lanes *a, const lanes *b, int at, double factor, const int more, const Wanted *of, const int crossed, const int k)
{
    const int one = (at + 1) % 3, two = (at + 2) % 3;
    gain(sum, a + one * k, b + two * k, factor, more, of, crossed, k);
    gain(sum, a + two * k, b + one * k, -factor, 1, of, crossed, k);
}

/* Every slot about a link's place, into `sum`. */
static INLINE void place_slots(
    const Task *t, const Room *w, int64_t l, const Moved *at, lanes *sum, const Wanted *of, const int crossed, const int k, const int n)
{
    for (int64_t s = t->reach[t->parts + l]; s < t->reach[t->parts + l + 1]; s++, sum += n) {
        const int64_t kind = t->slot[5 * s], side = kind > FIRST;
        const int row = (int)t->slot[5 * s + 2];
        const lanes *o = w->placed + 6 * k * t->link[4 * l + 1 + side] + 3 * k, *g = at->world + 6 * side * k;
        if (kind == FIRST || kind == SECOND) gain_product(sum, o, g, row, 2.0, 0, of, crossed, k);
        else {
            gain_product(sum, at->seen + 3 * side * k, g, row, -2.0, 0, of, crossed, k);
            gain_product(sum, o, g + 3 * k, row, -2.0, 1, of, crossed, k);
        }
    }
}

/* Every slot about a body's inertia, into `sum`. */
static INLINE void body_slots(const Task *t, const Room *w, int64_t b, lanes *sum, const Wanted *of, const int crossed, const int k, const int n)
{
    const int64_t group = t->parts + t->links + b;
    const lanes *x = w->placed + 6 * k * b, *o = x + 3 * k;
    for (int64_t s = t->reach[group]; s < t->reach[group + 1]; s++, sum += n) {
        const int at = (int)t->slot[5 * s + 2];
        if (!at)
            for (int i = 0; i < 3; i++) gain(sum, x + i * k, x + i * k, 1.0, i > 0, of, crossed, k);
        else if (at < 4) gain_product(sum, x, o, at - 1, 2.0, 0, of, crossed, k);
        else {
            const int row = at < 5 ? 0 : at < 7 ? 1 : 2, column = at - 4 - LOWER(row, 0);
            gain(sum, o + row * k, o + column * k, row == column ? 1.0 : 2.0, 0, of, crossed, k);
        }
    }
}

/* Masses and inertias of a group times - lambda: the same for both modes where it matters, within a cluster. */
static INLINE void weigh_slots(const Task *t, int64_t group, lanes *sum, const Wanted *of, const int k, const int n)
{
    for (int64_t s = t->reach[group]; s < t->reach[group + 1]; s++, sum += n) {
        if (t->slot[5 * s] == STIFFNESS) continue;
        EACH_MODE for (int p = 0; p < k; p++) sum[p] *= -of->mean[p];
        for (int p = k; p < n; p++) sum[p] *= -of->mean[of->pair[p].i];
    }
}

/* Whether the compiler knows a number. */
#define KNOWN(n) __builtin_constant_p(n)

/* From the slots of a group (a part, a link, a body) to variables; n is the number of pairs. */
static INLINE void contract(const Task *t, Room *w, int64_t group, const lanes *sum, const int n)
{
    const int64_t *run = t->run + 2 * t->about[group], *const end = t->run + 2 * t->about[group + 1];
    const Spot spot = w->spot;
    sum -= t->reach[group] * n;
    for (; run < end; run += 2) {
        const int64_t *entry = t->entry + 2 * run[1], *const last = t->entry + 2 * run[3];
        lanes own[USUAL], *to = w->slope + run[0] * n; /* where their number is known */
        if (KNOWN(n)) EACH_MODE for (int p = 0; p < n; p++) own[p] = to[p];
        for (; entry < last; entry += 2) {
            const lanes change = read_row(t->changes + entry[1] * t->slopes_stride, spot), *of = sum + entry[0] * n;
            if (KNOWN(n))
                EACH_MODE for (int p = 0; p < n; p++) own[p] += change * of[p];
            else
                for (int p = 0; p < n; p++) to[p] += change * of[p];
        }
        if (KNOWN(n)) EACH_MODE for (int p = 0; p < n; p++) to[p] = own[p];
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
        if (law || moves) move_link(t, w, l, &at, k);
        if (law) law_slots(t, l, &at, own, of, 0, k, n);
        if (law && more) law_slots(t, l, &at, own, of, 1, k, n);
        if (law && last) weigh_slots(t, part, own, of, k, n), contract(t, w, part, own, n);
        if (!moves) continue;
        int turned = 0;
        for (int64_t s = t->reach[place]; s < t->reach[place + 1]; s++) turned |= t->slot[5 * s] == FIRST_TURN || t->slot[5 * s] == SECOND_TURN;
        load_link(t, w, l, &at, of->mean, turned, k), place_slots(t, w, l, &at, other, of, 0, k, n);
        if (more) place_slots(t, w, l, &at, other, of, 1, k, n);
        contract(t, w, place, other, n);
    }
    for (int64_t b = 0; b < t->bodies; b++) {
        const int64_t group = t->parts + t->links + b;
        body_slots(t, w, b, w->sum, of, 0, k, n);
        if (more) body_slots(t, w, b, w->sum, of, 1, k, n);
        weigh_slots(t, group, w->sum, of, k, n), contract(t, w, group, w->sum, n);
    }
}

static void derive(const Task *t, Room *w, const lanes *value)
{
    const int64_t design = w->design;
    const int k = t->count < MODES ? (int)t->count : MODES;
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
        const lanes *x = w->found + t->row[b];
        lanes u[6], *to = w->placed + 6 * k * b;
        const int64_t own = t->through[b], next = t->copies[b];
        for (int c = 0; c < k; c++) {
            UNROLL for (int i = 0; i < 6; i++) u[own < 0 ? i : SPOT[i]] = x[c * t->rows + i * next];
            if (own < 0)
                UNROLL for (int i = 0; i < 6; i++) to[i * k + c] = u[i];
            else {
                const lanes *q = w->view[own].q;
                UNROLL for (int i = 0; i < 6; i++)
                    to[i * k + c] = q[3 * (i % 3)] * u[i - i % 3] + q[3 * (i % 3) + 1] * u[i - i % 3 + 1] + q[3 * (i % 3) + 2] * u[i - i % 3 + 2];
            }
        }
    }
    for (; pairs < k; pairs++) pair[pairs].i = pair[pairs].j = pairs;
    for (int i = 0; i < k; i++)
        for (int j = i + 1; j < k; j++)
            if (any(same[i * k + j])) pair[pairs].i = i, pair[pairs++].j = j;
    const Wanted of = {mean, pair, pairs};
    if (k == USUAL && pairs == USUAL) sum_slots(t, w, &of, USUAL, USUAL);
    else if (k == USUAL) sum_slots(t, w, &of, USUAL, pairs);
    else sum_slots(t, w, &of, k, pairs);
    for (int p = 0; p < k; p++)
        for (int64_t variable = 0; variable < t->variables; variable++)
            store(t->slopes + (p * t->variables + variable) * t->stride + design, w->slope[variable * pairs + p]);
    if (pairs == k) return;
    double *const between = t->between + design / WIDTH * (k * (k - 1) / 2) * t->variables * WIDTH;
    t->crossed[design / WIDTH] = 1;
    memset(between, 0, sizeof(lanes) * (k * (k - 1) / 2) * t->variables);
    for (int p = k; p < pairs; p++) {
        const int i = pair[p].i, j = pair[p].j, row = i * (2 * k - i - 1) / 2 + j - i - 1;
        for (int64_t variable = 0; variable < t->variables; variable++)
            store(between + (row * t->variables + variable) * WIDTH, (lanes)(same[i * k + j] & (marks)w->slope[variable * pairs + p]));
    }
}

/* ---- one vector of designs ---- */

/* The modes of the lanes that are done in this round and were not before. Where they all are, and are the same ones, they stay where they are. */
static void keep(const Task *t, Room *w, const Ritz *known, const Verdict *verdict, marks fresh, lanes *value, lanes *share)
{
    const int m = (int)t->single, k = (int)t->count;
    int from[MODES][WIDTH], whole = !any(~fresh);
    for (int c = 0; c < k; c++)
        for (int lane = 0; lane < WIDTH; lane++) {
            if (!fresh[lane]) continue;
            int at = 0;
            for (int seen = -1; at < m; at++)
                if (verdict[lane].mask[at] && ++seen == c) break;
            from[c][lane] = at, whole &= at == c;
            value[c][lane] = known->values[at][lane], share[c][lane] = known->share[at][lane];
        }
    w->found = whole ? w->now : w->shapes;
    for (int c = 0; c < k && t->variables && !whole; c++)
        for (int64_t r = 0; r < 6 * t->bodies; r++)
            for (int lane = 0; lane < WIDTH; lane++)
                if (fresh[lane]) w->shapes[c * t->rows + r][lane] = w->now[from[c][lane] * t->rows + r][lane];
}

static void designs(const Task *t, Room *w)
{
    const int64_t design = w->design;
    Verdict verdict[WIDTH];
    Ritz known;
    lanes value[MODES], share[MODES], shift = all(0.0);
    Count told = {all(0.0), all(INFINITY)};
    int left = WIDTH;
    for (int i = 0; i < t->count; i++) value[i] = all(1.0), share[i] = all(0.0);
    w->found = w->shapes; /* of lanes that are never done some modes or other: they are not told */
    for (int lane = 0; lane < WIDTH; lane++) verdict[lane].done = 0;
    const marks bad = assemble(t, w);
    if (!any(~bad)) {
        for (int lane = 0; lane < WIDTH; lane++) t->good[design + lane] = -1;
        return;
    }
    eliminate(t, w, all(0.0), 0);
    memcpy(w->root, w->other + OWN * (t->bodies - 1), sizeof w->root);
    if (t->m == USUAL && t->single == USUAL) begin(t, w, &known, USUAL, USUAL);
    else begin(t, w, &known, (int)t->m, (int)t->single);
    for (int64_t round = 0; round < t->rounds && left; round++) {
        const int64_t once = !round || ONCE(t->once, t->single - 1) ? t->once : 0; /* the last takes one step where all do: else, once more, all take two */
        if (round) { /* M times the modes */
            blend(6 * t->bodies, (int)t->single, (Layout){1, t->rows}, t->rows, w->ahead, w->force, known.mix, 0, (int)t->single);
            memcpy(once ? w->next : w->force, w->ahead, sizeof(lanes) * t->rows * t->single);
        }
        polish(t, w, &known, once);
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
    eliminate(t, w, shift, &told);
    for (int lane = 0; lane < WIDTH; lane++)
        t->good[design + lane] = bad[lane] ? -1 : verdict[lane].done && told.least[lane] > t->pivot && told.negative[lane] == (double)verdict[lane].below;
    for (int i = 0; i < t->count; i++)
        store(t->values + i * t->stride + design, value[i]), store(t->share + i * t->stride + design, share[i]);
    if (t->variables) derive(t, w, value);
}

/* ---- what of the numbers is the same in every design ---- */

/* Rows of numbers that are not the same in all designs, and how many; the others go where they are used, once. What is below the diagonal of symmetric
 * matrices is never read: its `mirror` stands for both. */
static int64_t vary(const Task *t, lanes *to, int64_t *varying)
{
    int64_t count = 0;
    for (int64_t i = 0; i < t->numbers; i++) {
        if (t->mirror[i] < i) continue;
        const double *own = t->numbers_ + i * t->numbers_stride;
        const lanes first = all(*own);
        marks other = {0};
        for (int64_t design = 0; !t->still[i] && design < t->designs && !any(other); design += 4 * WIDTH)
            for (int64_t k = design; k < design + 4 * WIDTH && k < t->designs; k += WIDTH)
                other |= read_row(own, spot_of(k, t->designs, t->numbers_portion)) != first;
        if (any(other)) varying[count++] = i;
        else to[i] = to[t->mirror[i]] = first;
    }
    return count;
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
    const int64_t own = OWN * (t->bodies + t->ports), edge = 36 * t->edges, block = t->rows * t->m, pairs = t->count * (t->count + 1) / 2;
    const int64_t sizes[] = {block, t->numbers, own, edge, own, edge, own, edge, block, block, block, block,
                             t->rows * t->count, 6 * t->bodies * t->count, t->widest * pairs, t->variables * pairs};
    const int count = sizeof sizes / sizeof *sizes;
    int64_t total = 0;
    for (int i = 0; i < count; i++) total += sizes[i] + 1;
    if (t->m > MOST || t->count > MODES || t->single > t->m) return 1;
    lanes *memory = aligned_alloc(sizeof(lanes), sizeof(lanes) * total), *at = memory;
    Room w;
    lanes **parts[] = {&w.start, &w.number, &w.stiff, &w.stiff_edge, &w.mass, &w.mass_edge, &w.other, &w.other_edge,
                       &w.now, &w.next, &w.force, &w.ahead, &w.shapes, &w.placed, &w.sum, &w.slope};
    for (int i = 0; i < count; i++) *parts[i] = at, at += sizes[i] + 1;
    if (memory) memset(w.shapes, 0, sizeof(lanes) * t->rows * t->count);
    int64_t *const varying = malloc(sizeof(int64_t) * t->numbers);
    char *const filled = malloc(t->numbers);
    int64_t *const crossing = malloc(sizeof(int64_t) * 180 * t->links);
    w.law = malloc(sizeof(Law) * t->parts);
    w.view = aligned_alloc(sizeof(lanes), sizeof(View) * (t->gates + 1)), w.side = aligned_alloc(sizeof(lanes), sizeof(Side) * t->links);
    w.fills = 0;
    for (int64_t u = 0; u < t->updates; u++) w.fills |= t->update[3 * u + 2] >= 0;
    const int short_of = !memory || !varying || !filled || !crossing || !w.law || !w.view || !w.side;
    if (!short_of) {
        const int64_t some = vary(t, w.number, varying);
        outlines(t, w.law, w.number, varying, some, filled);
        for (int64_t i = 0; i < 6 * t->bodies * t->m; i++) w.start[i] = all(t->force[i]);
        w.crossing = crossing, w.crossings = 0;
        for (int64_t l = 0; l < t->links; l++)
            for (int64_t i = 0; i < 36 + 144 && t->normal[l] >= 0; i++) {
                const int row = (int)(i < 36 ? i / 6 : (i - 36) / 12 % 6), column = (int)(i < 36 ? i % 6 : (i - 36) % 6);
                const int64_t at = i < 36 ? t->start[0] + 36 * t->link[4 * l] + i : t->start[1] + 144 * t->link[4 * l] + i - 36;
                if (filled[at] && (row / 3 == column / 3) != ((row % 3 == t->normal[l]) == (column % 3 == t->normal[l]))) w.crossing[w.crossings++] = at;
            }
        for (w.design = 0; w.design < t->designs; w.design += WIDTH) {
            const Spot spot = spot_of(w.design, t->designs, t->numbers_portion);
            w.spot = spot_of(w.design, t->designs, t->slopes_portion);
            for (int64_t i = 0; i < some; i++)
                w.number[varying[i]] = w.number[t->mirror[varying[i]]] = read_row(t->numbers_ + varying[i] * t->numbers_stride, spot);
            designs(t, &w);
        }
    }
    free(memory), free(varying), free(filled), free(crossing), free(w.law), free(w.view), free(w.side);
    return short_of;
}
