/* Platform modes of many designs, several per vector. A "lane" is one design. Lanes are independent, so that results do not depend on the other
 * designs of a call. Stiffness K and inertia M are 6x6 blocks of bodies and of pairs of connected bodies, eliminated in the order of graph.py;
 * choice.py explains which modes are platform modes. The requested modes are computed singly:
 *
 * 1. Z = (K - sigma M)^-1 F for the inertial forces F of the nominal modes, sigma between their values; Rayleigh-Ritz on Z.
 * 2. For each requested mode x of these, sigma just below its value and T = (K - sigma M)^-1 M: y = T x. Rayleigh-Ritz on the y only, with
 *    K y = sigma M y + M x.
 * 3. T's Rayleigh quotient theta at x and the residual |y - theta x| in M bound the part of y in modes whose lambda is `outer` or more. T is at
 *    most 1 / (outer - sigma) there: its sine is at most (sine of the angle between x and y) / ((outer - sigma) theta - 1).
 * 4. The number of negative pivots of K - shift M equals the number of values below the shift: none is missed.
 *
 * Own blocks of bodies are lower triangles by rows, edges 6x6 by rows; vectors are [body][6][m]; every entry is a vector of WIDTH designs.
 */
#include "lanes.h"

#define MOST 16     /* vectors of a block */
#define MODES 12    /* maximum requested modes */
#define ROUNDING 1e-15
#define BESIDE 1e-7 /* relative distance of a single mode's shift below its value: its matrix is never singular */
#define ABOVE 5e-3  /* relative distance above the last requested value of the shift that counts the values below */

typedef double loose __attribute__((vector_size(WIDTH * 8), aligned(8)));

typedef struct {
    /* sizes */
    int64_t designs, stride, bodies, links, edges, updates, numbers, parts, m, count, rounds, single;
    /* tables */
    const int64_t *link;    /* links x (part, place of first body, place of second body, edge); -1: the ground, no edge */
    const int64_t *range;   /* bodies + 1: offset of the edges of each body */
    const int64_t *later;   /* edges: the later body */
    const int64_t *heavy;   /* edges: whether it has a link */
    const int64_t *product; /* bodies + 1: offset of the updates of each body */
    const int64_t *update;  /* updates x (edge, edge, target); -1: the later body's own block */
    const int64_t *mirror;  /* numbers: index of the equal number by symmetry, or its own index */
    const int64_t *inertia; /* bodies: offset of the body's inertia among the numbers */
    const int64_t *start;   /* stiffness, mass, turn, first, second */
    const double *force;    /* 6 bodies x m: inertial forces of the start modes */
    const double *numbers_; /* numbers x designs */
    /* settings */
    double shift, value, cluster, together, threshold, margin, pivot;
    /* results */
    double *values;         /* count x stride, whole vectors of designs */
    int64_t *good;          /* designs: 1 if proven, else 0 */
} Task;

#define INLINE inline __attribute__((always_inline))
#if defined(__clang__)
#define UNROLL /* unrolls by default, and is slower with the pragma */
#else
#define UNROLL _Pragma("GCC unroll 36") /* small fixed loops: their data stay in registers */
#endif

/* ---- lanes ---- */

static inline lanes root(lanes a) { for (int i = 0; i < WIDTH; i++) a[i] = sqrt(a[i]); return a; }
static inline lanes load(const double *p) { return *(const loose *)p; }
/* Load some lanes; the last design fills the others. A separate function, to keep registers of hot loops free. */
static __attribute__((noinline, cold)) lanes load_some(const double *p, int64_t count)
{
    lanes r;
    for (int i = 0; i < WIDTH; i++) r[i] = p[i < count ? i : count - 1];
    return r;
}
static inline void store(double *p, lanes a) { *(loose *)p = a; }

/* Load a row of numbers for the designs from this one on, and prefetch the next vector. */
static inline lanes read_row(const Task *t, int64_t row, int64_t design)
{
    const double *const at = t->numbers_ + row * t->designs + design;
    const int64_t left = t->designs - design;
    __builtin_prefetch(at + (left > WIDTH ? WIDTH : 0), 0, 2);
    return left >= WIDTH ? load(at) : load_some(at, left);
}

/* ---- 6x6 blocks ---- */

#define OWN 21
#define LOWER(i, k) ((i) * ((i) + 1) / 2 + (k)) /* k <= i */

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

/* `what` for three of `wide` columns from j on at once, then for the remaining ones. */
#define IN_THREES(what)                                                   \
    {                                                                     \
        int j = 0;                                                        \
        for (; j + 3 <= wide; j += 3) { enum { n = 3 }; what; }           \
        if (wide - j == 2) { enum { n = 2 }; what; }                      \
        else if (wide - j == 1) { enum { n = 1 }; what; }                 \
    }
/* ---- assembly ---- */

/* out (6x6) = 3x3 blocks of `from`, `stride` wide, rotated to stage axes: R block R^T; symmetric blocks fill the upper half. */
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

/* 3x3 blocks of a part's law and mass that are zero in every design (4 and 16). */
typedef struct { int zero[20]; } Law;

typedef struct {
    Law *law;
    int fills;                       /* whether elimination creates edges */
    int64_t design;                  /* the first of these designs */
    lanes *number;                   /* their numbers */
    lanes *stiff, *stiff_edge;       /* K */
    lanes *mass, *mass_edge;         /* M */
    lanes *other, *other_edge;       /* K - shift M factored */
    lanes *now, *next, *force, *ahead, *start; /* blocks of vectors; the start vectors are equal in all lanes */
    lanes root[OWN];                 /* L D L^T of the inverse platform compliance, from `invert` */
} Room;

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

/* Adds a link. */
static void add_link(const Task *t, Room *w, int64_t l)
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

/* 6x6 inertia (lower triangle) of a body from its mass, moments of mass (3) and moments of inertia (lower triangle, 6). */
static INLINE void weigh(lanes *own, const lanes *n)
{
    UNROLL for (int i = 0; i < OWN; i++) own[i] = all(0.0);
    UNROLL for (int i = 0; i < 3; i++) {
        own[LOWER(i, i)] = n[0];
        own[LOWER(3 + (i + 2) % 3, (i + 1) % 3)] = n[1 + i], own[LOWER(3 + (i + 1) % 3, (i + 2) % 3)] = -n[1 + i];
        UNROLL for (int k = 0; k <= i; k++) own[LOWER(3 + i, 3 + k)] = n[4 + LOWER(i, k)];
    }
}

static void assemble(const Task *t, Room *w)
{
    memset(w->stiff, 0, sizeof(lanes) * OWN * t->bodies);
    memset(w->stiff_edge, 0, sizeof(lanes) * 36 * t->edges), memset(w->mass_edge, 0, sizeof(lanes) * 36 * t->edges);
    for (int64_t b = 0; b < t->bodies; b++) weigh(w->mass + OWN * b, w->number + t->inertia[b]);
    for (int64_t l = 0; l < t->links; l++) add_link(t, w, l);
}

/* ---- elimination ---- */

/* Number of negative pivots in each lane, and the minimum over its own entry of K. */
typedef struct { lanes negative, least; } Count;

static INLINE void count_pivots(Count *told, const lanes *pivot, const lanes *stiff)
{
    UNROLL for (int s = 0; s < 6; s++) {
        const lanes ratio = size_of(pivot[s]) / stiff[LOWER(s, s)];
        told->negative += pick(pivot[s] < 0.0, all(1.0), all(0.0));
        told->least = pick(ratio >= told->least, told->least, ratio);
    }
}

/* Product of two edges of body v, which elimination subtracts from the block of two later bodies. */
static INLINE void join_update(Room *w, int64_t v, const int64_t *edges)
{
    const lanes *own = w->other + OWN * v, *x = w->other_edge + 36 * edges[0], *y = w->other_edge + 36 * edges[1];
    for (int c = 0; c < 6; c++) {
        lanes scaled[6];
        UNROLL for (int i = 0; i < 6; i++) scaled[i] = own[LOWER(i, i)] * y[6 * i + c];
        multiply(w->other_edge + 36 * edges[2] + c, x, scaled, 6, TURNED, 1, 1);
    }
}

/* Eliminate a body, whose own block K - shift M includes the updates of previous bodies. */
static INLINE void eliminate_body(const Task *t, Room *w, int64_t v, lanes shift, Count *told)
{
    lanes pivot[6], *own = w->other + OWN * v;
    invert(own, pivot, 6);
    if (told) count_pivots(told, pivot, w->stiff + OWN * v);
    for (int64_t e = t->range[v]; e < t->range[v + 1]; e++) reduce(w->other_edge + 36 * e, w->stiff_edge + 36 * e, w->mass_edge + 36 * e, shift, own, w->fills);
    for (int64_t u = t->product[v]; u < t->product[v + 1]; u++) {
        lanes *later = w->other + OWN * t->later[t->update[3 * u]];
        const lanes *x = w->other_edge + 36 * t->update[3 * u];
        if (t->update[3 * u + 2] >= 0) join_update(w, v, t->update + 3 * u);
        else update(later, x, own, 3), update(later, x, own, 0);
    }
}

/* w->other, w->other_edge = K - shift M = L D L^T: own blocks from `invert`, edges times L^-1; returns the pivot counts. */
static void eliminate(const Task *t, Room *w, lanes shift, Count *told)
{
    for (int64_t i = 0; i < OWN * t->bodies; i++) w->other[i] = w->stiff[i] - shift * w->mass[i];
    if (w->fills)
        for (int64_t i = 0; i < 36 * t->edges; i++) w->other_edge[i] = w->stiff_edge[i] - shift * w->mass_edge[i];
    for (int64_t v = 0; v < t->bodies; v++) eliminate_body(t, w, v, shift, told);
}

/* Columns of a body from j on. */
#define ROWS(x, v) ((x) + 6 * (v) * m + j)

/* A body forward, n of m columns: x = (K - shift M)^-1 f. */
static INLINE void forward(const Task *t, const Room *w, lanes *x, int64_t v, int m, int j, const int n)
{
    const lanes *a = w->other + OWN * v;
    lanes u[24], *own = ROWS(x, v);
    pick_columns(u, own, m, n);
    lower(u, a, n);
    UNROLL for (int i = 0; i < 6; i++)
        UNROLL for (int k = 0; k < n; k++) own[i * m + k] = u[i * n + k] *= a[LOWER(i, i)];
    for (int64_t e = t->range[v]; e < t->range[v + 1]; e++) multiply(ROWS(x, t->later[e]), w->other_edge + 36 * e, u, m, TURNED, 1, n);
}

/* The same backward, and the contribution of the body to y = M x. */
static INLINE void backward(const Task *t, const Room *w, lanes *x, lanes *y, int64_t v, int m, int j, const int n)
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

/* x = (K - shift M)^-1 f, m vectors, eliminated for it, and y = M x. */
static INLINE void solve(const Task *t, Room *w, lanes *x, const lanes *f, lanes *y, lanes shift, const int m)
{
    const int wide = m;
    eliminate(t, w, shift, 0);
    memcpy(x, f, sizeof(lanes) * 6 * t->bodies * m);
    for (int64_t v = 0; v < t->bodies; v++) IN_THREES(forward(t, w, x, v, m, j, n))
    for (int64_t v = t->bodies - 1; v >= 0; v--) IN_THREES(backward(t, w, x, y, v, m, j, n))
}

/* The dot of two vectors, of an even number of rows. */
static INLINE lanes dot(const lanes *x, const lanes *y, int64_t rows)
{
    lanes sum[2] = {all(0.0), all(0.0)};
    for (int64_t i = 0; i < rows; i += 2) sum[0] += x[i] * y[i], sum[1] += x[i + 1] * y[i + 1];
    return sum[0] + sum[1];
}

/* ---- Rayleigh-Ritz ---- */

/* Entry (r, i) of m vectors: side by side (row m, column 1) or one after the other (row 1, column n). */
typedef struct { int64_t row, column; } Layout;

/* Dots of ni vectors x from i0 on with nj of y and of z from j0 on, or (`half`) the lower half of them; z is equal in all lanes if `plain`. */
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

/* y = x q, for columns c to `count` - 1, one after the other, at distance `next`. */
static INLINE void blend(int64_t n, int m, Layout at, int64_t next, lanes *restrict y, const lanes *restrict x, const lanes *restrict q, int c, int count)
{
    for (; c + 3 <= count; c += 3) blends(n, m, at, next, y, x, q, c, 3);
    if (count - c == 2) blends(n, m, at, next, y, x, q, c, 2);
    else if (count - c == 1) blends(n, m, at, next, y, x, q, c, 1);
}

/* Eigenvalues on the diagonal of a and vectors in v (columns), by Jacobi rotations; each lane stops individually. */
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
                const lanes t = pick(turn, two / pick(apart < 0.0, apart - far, apart + far), all(0.0)); /* tangent of the angle that makes o zero */
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
    marks other = {0}; /* lanes that are not in order */
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

/* Of single modes: the shift of each, the Rayleigh quotient of (K - shift M)^-1 M, the sine of the angle between a vector and its image,
 * the part of each in each of the modes, and the modal participation in the platform compliance. */
typedef struct { lanes values[MOST], shift[MOST], quotient[MOST], sine[MOST], part[MOST * MOST], mix[MOST * MOST], gain[MOST * 6]; } Ritz;

/* Rayleigh-Ritz on (K - shift M)^-1 times the start forces: all values, and M times the requested modes in w->next. */
static INLINE void begin(const Task *t, Room *w, Ritz *out, const int m, const int single)
{
    const int64_t n = 6 * t->bodies;
    lanes stiff[MOST * MOST], mass[MOST * MOST], q[MOST * MOST];
    solve(t, w, w->ahead, w->start, w->now, all(t->shift), m);
    grams(n, m, (Layout){m, 1}, mass, stiff, w->ahead, w->now, 0, t->force);
    for (int i = 0; i < m * m; i++) stiff[i] += t->shift * mass[i];
    small(m, stiff, mass, out->values, q, 1e-6);
    blend(n, m, (Layout){m, 1}, n, w->next, w->now, q, 0, single);
}

/* Rayleigh-Ritz on single modes in w->ahead: shapes in w->now; M times them are in w->force, M times their source in w->next. */
static INLINE void combine(const Task *t, Room *w, Ritz *known, const int m)
{
    const int64_t n = 6 * t->bodies;
    const Layout at = {1, n};
    lanes stiff[MOST * MOST], mass[MOST * MOST], length[MOST];
    grams(n, m, at, mass, stiff, w->ahead, w->force, w->next, 0);
    for (int i = 0; i < m; i++)
        for (int j = 0; j <= i; j++) stiff[i * m + j] = stiff[j * m + i] = known->shift[j] * mass[i * m + j] + stiff[i * m + j];
    for (int i = 0; i < m; i++) length[i] = root(mass[i * m + i]);
    small(m, stiff, mass, known->values, known->mix, ROUNDING);
    blend(n, m, at, n, w->now, w->ahead, known->mix, 0, m);
    for (int c = 0; c < m; c++) {
        for (int k = 0; k < m; k++) known->part[c * m + k] = size_of(known->mix[k * m + c]) * length[k];
        const lanes *seen = w->now + c * n + n - 6;
        for (int i = 0; i < 6; i++) {
            lanes sum = seen[i];
            for (int k = i + 1; k < 6; k++) sum += w->root[LOWER(k, i)] * seen[k];
            known->gain[6 * c + i] = sum / root(w->root[LOWER(i, i)] * known->values[c]);
        }
    }
}

/* The requested modes one by one, from M times them in w->next, by a step of inverse iteration with a shift just below each value, and Rayleigh-Ritz on them:
 * to shapes (single, 6 bodies) in w->now. The part of other modes decreases like the distance of the value from the shift over theirs. */
static void polish(const Task *t, Room *w, Ritz *known)
{
    const int m = (int)t->single;
    const int64_t n = 6 * t->bodies;
    for (int c = 0; c < m; c++) {
        lanes *const x = w->ahead + c * n, *const from = w->next + c * n, *const to = w->force + c * n;
        known->shift[c] = (1.0 - BESIDE) * known->values[c];
        solve(t, w, x, from, to, known->shift[c], 1);
        const lanes between = dot(x, from, n), square = 1.0 - between * between / dot(x, to, n);
        known->sine[c] = root(pick(square > 0.0, square, all(0.0)));
        known->sine[c] = pick(square == square, known->sine[c], square);
        known->quotient[c] = between;
    }
    combine(t, w, known, m);
}

/* ---- selection of the platform modes, one design at a time ---- */

typedef struct { int done, below, mask[MOST]; double shift; } Verdict; /* `mask`: platform modes */

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
    if (first == m) value[m] = value[m - 1] * (1.0 + 10.0 * ABOVE); /* no further value: the count shows that there is none up to slightly above these */
    out->below = first, out->shift = value[first - 1] + 0.1 * (value[first] - value[first - 1]);
    /* Part of a single vector in modes beyond, after (K - shift M)^-1 M, whose values there are at most 1 / (outer - shift). */
    const double outer = out->shift;
    double beyond[MOST];
    for (int k = 0; k < single; k++) {
        const double far = (outer - known->shift[k][lane]) * fabs(known->quotient[k][lane]) - 1.0;
        beyond[k] = k < first && far > known->sine[k][lane] ? known->sine[k][lane] / far : 1.0;
    }
    for (int i = 0; i < needed; i++) {
        double angle = 0.0;
        for (int k = 0; k < single; k++) angle += known->part[i * single + k][lane] * beyond[k];
        if (!(angle * angle * outer / value[i] <= t->value)) return;
    }
    out->done = value[0] > BESIDE * value[first - 1];
}

/* ---- one vector of designs ---- */

static void designs(const Task *t, Room *w)
{
    const int64_t design = w->design, n = 6 * t->bodies;
    const int single = (int)t->single;
    Verdict verdict[WIDTH];
    Ritz known;
    lanes value[MODES], shift = all(0.0);
    Count told = {all(0.0), all(INFINITY)};
    int left = WIDTH;
    for (int i = 0; i < t->count; i++) value[i] = all(1.0);
    for (int lane = 0; lane < WIDTH; lane++) verdict[lane].done = 0;
    assemble(t, w);
    eliminate(t, w, all(0.0), 0);
    memcpy(w->root, w->other + OWN * (t->bodies - 1), sizeof w->root);
    begin(t, w, &known, (int)t->m, single);
    for (int64_t round = 0; round < t->rounds && left; round++) {
        if (round) { /* M times the modes */
            blend(n, single, (Layout){1, n}, n, w->ahead, w->force, known.mix, 0, single);
            memcpy(w->next, w->ahead, sizeof(lanes) * n * single);
        }
        polish(t, w, &known);
        left = 0;
        for (int lane = 0; lane < WIDTH; lane++) {
            if (verdict[lane].done) continue;
            judge(t, &known, lane, &verdict[lane]);
            left += !verdict[lane].done;
            shift[lane] = verdict[lane].done ? verdict[lane].shift : shift[lane];
            for (int at = 0, c = 0; verdict[lane].done && at < single; at++)
                if (verdict[lane].mask[at]) value[c++][lane] = known.values[at][lane];
        }
    }
    eliminate(t, w, shift, &told);
    for (int lane = 0; lane < WIDTH; lane++)
        t->good[design + lane] = verdict[lane].done && told.least[lane] > t->pivot && told.negative[lane] == (double)verdict[lane].below;
    for (int i = 0; i < t->count; i++) store(t->values + i * t->stride + design, value[i]);
}

/* ---- numbers that are equal in every design ---- */

/* Rows of numbers that differ between designs, and their count; the others are stored once. Entries below the diagonal of symmetric
 * matrices are never read: `mirror` gives the equal entry. */
static int64_t vary(const Task *t, lanes *to, int64_t *varying)
{
    int64_t count = 0;
    for (int64_t i = 0; i < t->numbers; i++) {
        if (t->mirror[i] < i) continue;
        const lanes first = all(t->numbers_[i * t->designs]);
        marks other = {0};
        for (int64_t design = 0; design < t->designs && !any(other); design += WIDTH) other |= read_row(t, i, design) != first;
        if (any(other)) varying[count++] = i;
        else to[i] = to[t->mirror[i]] = first;
    }
    return count;
}

/* Blocks (3x3) of a matrix (`rows` x `rows`) that are zero in all designs. */
static void outline(const char *filled, int rows, int *zero)
{
    const int blocks = rows / 3;
    for (int i = 0; i < blocks * blocks; i++) zero[i] = 1;
    for (int i = 0; i < rows * rows; i++)
        if (filled[i]) zero[blocks * (i / rows / 3) + i % rows / 3] = 0;
}

static void outlines(const Task *t, Law *law, const lanes *number, const int64_t *varying, int64_t count, char *filled)
{
    for (int64_t i = 0; i < t->numbers; i++) filled[i] = number[i][0] != 0.0;
    for (int64_t i = 0; i < count; i++) filled[varying[i]] = filled[t->mirror[varying[i]]] = 1;
    for (int64_t part = 0; part < t->parts; part++, law++) {
        outline(filled + t->start[0] + 36 * part, 6, law->zero);
        outline(filled + t->start[1] + 144 * part, 12, law->zero + 4);
    }
}

int64_t flexstage_width(void) { return WIDTH; }

/* Every design of the task; returns 0, or 1 if it is too large. */
int64_t flexstage_modes(const Task *t)
{
    const int64_t own = OWN * t->bodies, edge = 36 * t->edges, block = 6 * t->bodies * t->m;
    const int64_t sizes[] = {block, t->numbers, own, edge, own, edge, own, edge, block, block, block, block};
    const int count = sizeof sizes / sizeof *sizes;
    int64_t total = 0;
    for (int i = 0; i < count; i++) total += sizes[i] + 1;
    if (t->m > MOST || t->count > MODES || t->single > t->m) return 1;
    lanes *memory = aligned_alloc(sizeof(lanes), sizeof(lanes) * total), *at = memory;
    Room w;
    lanes **parts[] = {&w.start, &w.number, &w.stiff, &w.stiff_edge, &w.mass, &w.mass_edge, &w.other, &w.other_edge, &w.now, &w.next, &w.force, &w.ahead};
    for (int i = 0; i < count; i++) *parts[i] = at, at += sizes[i] + 1;
    int64_t *const varying = malloc(sizeof(int64_t) * t->numbers);
    char *const filled = malloc(t->numbers);
    w.law = malloc(sizeof(Law) * t->parts);
    w.fills = 0;
    for (int64_t u = 0; u < t->updates; u++) w.fills |= t->update[3 * u + 2] >= 0;
    const int short_of = !memory || !varying || !filled || !w.law;
    if (!short_of) {
        const int64_t some = vary(t, w.number, varying);
        outlines(t, w.law, w.number, varying, some, filled);
        for (int64_t i = 0; i < block; i++) w.start[i] = all(t->force[i]);
        for (w.design = 0; w.design < t->designs; w.design += WIDTH) {
            for (int64_t i = 0; i < some; i++) w.number[varying[i]] = w.number[t->mirror[varying[i]]] = read_row(t, varying[i], w.design);
            designs(t, &w);
        }
    }
    free(memory), free(varying), free(filled), free(w.law);
    return short_of;
}
