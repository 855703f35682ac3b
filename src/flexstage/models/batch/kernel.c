/* Platform modes of many designs, several of them in each vector: the same steps in the same order as subspace.py, factor.py, blocks.py and
 * slopes.py, where they are explained. A "lane" is one design; nothing that happens in a lane depends on the others, so results do not
 * depend on which designs are computed together.
 *
 * Matrices are 6x6 blocks by rows; vectors are [body][6][m]; every entry is a vector of WIDTH designs.
 */
#include "lanes.h"

#define MOST 16     /* vectors of a block */
#define MODES 12    /* modes that may be asked for */
#define BESIDE 1e-6 /* how far below its value a single mode's shift is: its matrix is never singular */
#define AHEAD 4     /* vectors of designs whose numbers are gathered at once: rows are far apart, and a page holds few */

typedef double loose __attribute__((vector_size(WIDTH * 8), aligned(8)));

typedef struct {
    /* sizes */
    int64_t designs, numbers_stride, slopes_stride, stride, bodies, links, edges, updates, numbers, m, count, degree, rounds, variables, slots, entries, single;
    /* tables */
    const int64_t *link;    /* links x (part, place of first body, place of second body, edge); -1: the ground, no edge */
    const int64_t *range;   /* bodies + 1: where the edges of each body begin */
    const int64_t *later;   /* edges: the later body */
    const int64_t *heavy;   /* edges: whether some link is on it */
    const int64_t *product; /* bodies + 1: where the updates of each body begin */
    const int64_t *update;  /* updates x (edge, edge, target); -1: the later body's own block */
    const int64_t *inertia; /* bodies: where the inertia of the body at that place begins among the numbers */
    const int64_t *start;   /* stiffness, mass, turn, first, second */
    const int64_t *slot;    /* slots x (kind, owner or place, row, column) */
    const int64_t *reach;   /* links + 1: where the slots of each link begin in the following */
    const int64_t *about;   /* slots that are about a link or its part */
    const int64_t *entry;   /* entries x (variable, slot), by variable */
    const int64_t *zero;    /* parts x 20: 3x3 blocks that are zero, 4 of the stiffness and 16 of the mass */
    const double *block;    /* bodies x 6 x m: what to begin with */
    const double *numbers_; /* numbers x numbers_stride */
    const double *changes;  /* entries x slopes_stride */
    /* settings */
    double edge, value, angle, limit, cluster, together, shares, margin, pivot;
    /* results */
    double *values, *share; /* count x stride, whole vectors of designs */
    int64_t *good;          /* designs */
    double *slopes;         /* variables x count x count x stride, zero */
} Task;

#define INLINE inline __attribute__((always_inline))

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

/* y (6, m) += sign a x, or sign a^T x, or, fresh, y = a x; columns in threes, so that each entry of a is used three times. All of x is read
 * of a column before any of y is written. */
#define COLUMNS(N)                                                                   \
    {                                                                                \
        lanes v[6 * N];                                                              \
        for (int c = 0; c < 6; c++)                                                  \
            for (int k = 0; k < N; k++) v[c * N + k] = x[c * m + j + k];             \
        _Pragma("GCC unroll 1") for (int r = 0; r < 6; r++) {                        \
            lanes s[N];                                                              \
            for (int k = 0; k < N; k++) s[k] = fresh ? all(0.0) : y[r * m + j + k];  \
            for (int c = 0; c < 6; c++) {                                            \
                const lanes e = turned ? a[c * 6 + r] : a[r * 6 + c];                \
                for (int k = 0; k < N; k++) s[k] = negative ? s[k] - e * v[c * N + k] : s[k] + e * v[c * N + k]; \
            }                                                                        \
            for (int k = 0; k < N; k++) y[r * m + j + k] = s[k];                     \
        }                                                                            \
    }

static INLINE void multiply(
    lanes *y, const lanes *restrict a, const lanes *x, int m, const int turned, const int negative, const int fresh)
{
    int j = 0;
    for (; j + 3 <= m; j += 3) COLUMNS(3)
    if (m - j == 2) COLUMNS(2)
    else if (m - j == 1) COLUMNS(1)
}

static void add(lanes *restrict y, const lanes *restrict a, const lanes *restrict x, int m) { multiply(y, a, x, m, 0, 0, 0); }
static void add_turned(lanes *restrict y, const lanes *restrict a, const lanes *restrict x, int m) { multiply(y, a, x, m, 1, 0, 0); }
static void take(lanes *restrict y, const lanes *restrict a, const lanes *restrict x, int m) { multiply(y, a, x, m, 0, 1, 0); }
static void take_turned(lanes *restrict y, const lanes *restrict a, const lanes *restrict x, int m) { multiply(y, a, x, m, 1, 1, 0); }
static void set(lanes *y, const lanes *restrict a, const lanes *x, int m) { multiply(y, a, x, m, 0, 0, 1); }

/* Inverse without exchange of rows, and the pivots. */
static void invert(lanes *a, lanes *pivots)
{
    for (int s = 0; s < 6; s++) {
        pivots[s] = a[s * 7];
        const lanes inverse = 1.0 / a[s * 7];
        lanes column[6], row[6];
        for (int i = 0; i < 6; i++) column[i] = a[i * 6 + s];
        for (int i = 0; i < 6; i++) row[i] = a[s * 6 + i] * inverse;
        for (int i = 0; i < 6; i++)
            for (int k = 0; k < 6; k++) a[i * 6 + k] -= column[i] * row[k];
        for (int i = 0; i < 6; i++) a[s * 6 + i] = row[i], a[i * 6 + s] = -column[i] * inverse;
        a[s * 7] = inverse;
    }
}

/* ---- assembly ---- */

/* out (6x6, 3x3 blocks at row0, col0 of `from`, `stride` wide) turned into the stage's axes: R block R^T. */
static void turn(lanes *out, const lanes *from, int stride, const lanes *r, const int64_t *zero)
{
    for (int p = 0; p < 2; p++)
        for (int q = 0; q < 2; q++) {
            lanes *o = out + 18 * p + 3 * q;
            const lanes *f = from + 3 * stride * p + 3 * q;
            lanes half[9];
            if (zero[(stride == 12 ? 4 : 2) * p + q]) {
                for (int i = 0; i < 3; i++)
                    for (int k = 0; k < 3; k++) o[6 * i + k] = all(0.0);
                continue;
            }
            for (int i = 0; i < 3; i++)
                for (int k = 0; k < 3; k++) half[3 * i + k] = r[3 * i] * f[k] + r[3 * i + 1] * f[stride + k] + r[3 * i + 2] * f[2 * stride + k];
            for (int i = 0; i < 3; i++)
                for (int k = 0; k < 3; k++) o[6 * i + k] = half[3 * i] * r[3 * k] + half[3 * i + 1] * r[3 * k + 1] + half[3 * i + 2] * r[3 * k + 2];
        }
}

/* out += sign T(a)^T n T(b), T = [1, [arm]x; 0, 1]; out turned if asked. */
static void carried(lanes *out, const lanes *n, const lanes *a, const lanes *b, double sign, int turned)
{
    lanes p[36];
    for (int i = 0; i < 6; i++) {
        const lanes *v = n + 6 * i;
        p[6 * i] = v[0], p[6 * i + 1] = v[1], p[6 * i + 2] = v[2];
        p[6 * i + 3] = v[3] + (v[1] * b[2] - v[2] * b[1]);
        p[6 * i + 4] = v[4] + (v[2] * b[0] - v[0] * b[2]);
        p[6 * i + 5] = v[5] + (v[0] * b[1] - v[1] * b[0]);
    }
    for (int k = 0; k < 6; k++) {
        const lanes x = p[k], y = p[6 + k], z = p[12 + k];
        p[18 + k] += y * a[2] - z * a[1];
        p[24 + k] += z * a[0] - x * a[2];
        p[30 + k] += x * a[1] - y * a[0];
    }
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < 6; k++) out[turned ? 6 * k + i : 6 * i + k] += sign * p[6 * i + k];
}

typedef struct {
    lanes *number, *change;          /* the numbers of these designs, and their derivatives */
    lanes *numbers, *changes;        /* those of AHEAD vectors of designs */
    lanes *stiff, *stiff_edge;       /* K */
    lanes *mass, *mass_edge;         /* M */
    lanes *inverse, *edge;           /* K factored */
    lanes *other, *other_edge;       /* K - sigma M factored */
    lanes *before, *now, *next, *force, *ahead, *heavy; /* blocks of vectors */
    lanes *shapes;                   /* modes found (6 bodies, count) */
    lanes *sum;                      /* slots x pairs */
} Room;

static void assemble(const Task *t, Room *w)
{
    memset(w->stiff, 0, sizeof(lanes) * 36 * t->bodies);
    memset(w->stiff_edge, 0, sizeof(lanes) * 36 * t->edges);
    memset(w->mass_edge, 0, sizeof(lanes) * 36 * t->edges);
    for (int64_t b = 0; b < t->bodies; b++) memcpy(w->mass + 36 * b, w->number + t->inertia[b], sizeof(lanes) * 36);
    for (int64_t l = 0; l < t->links; l++) {
        const int64_t part = t->link[4 * l], a = t->link[4 * l + 1], b = t->link[4 * l + 2], e = t->link[4 * l + 3];
        const lanes *r = w->number + t->start[2] + 9 * l, *first = w->number + t->start[3] + 3 * l, *second = w->number + t->start[4] + 3 * l;
        const lanes *m = w->number + t->start[1] + 144 * part;
        const int64_t *zero = t->zero + 20 * part;
        lanes n[36];
        turn(n, w->number + t->start[0] + 36 * part, 6, r, zero);
        if (a >= 0) carried(w->stiff + 36 * a, n, first, first, 1.0, 0);
        if (b >= 0) carried(w->stiff + 36 * b, n, second, second, 1.0, 0);
        if (e >= 0) carried(w->stiff_edge + 36 * e, n, first, second, -1.0, a > b);
        if (a >= 0) turn(n, m, 12, r, zero + 4), carried(w->mass + 36 * a, n, first, first, 1.0, 0);
        if (b >= 0) turn(n, m + 78, 12, r, zero + 14), carried(w->mass + 36 * b, n, second, second, 1.0, 0);
        if (e >= 0) turn(n, m + 6, 12, r, zero + 6), carried(w->mass_edge + 36 * e, n, first, second, 1.0, a > b);
    }
}

/* Factor in place: own blocks become inverses, edges those of L^T. Gives per lane how many pivots are negative and the least pivot over its
 * own diagonal entry. */
static void eliminate(const Task *t, lanes *own, lanes *edge, lanes *negative, lanes *least)
{
    *negative = all(0.0), *least = all(INFINITY);
    lanes diagonal[6 * t->bodies];
    for (int64_t i = 0; i < 6 * t->bodies; i++) diagonal[i] = own[36 * (i / 6) + 7 * (i % 6)];
    for (int64_t v = 0; v < t->bodies; v++) {
        lanes pivots[6], plain[36];
        invert(own + 36 * v, pivots);
        for (int i = 0; i < 6; i++) {
            const lanes ratio = pivots[i] / diagonal[6 * v + i];
            *negative += pick(pivots[i] < 0.0, all(1.0), all(0.0));
            *least = pick(ratio >= *least, *least, ratio);
        }
        for (int64_t e = t->range[v]; e < t->range[v + 1]; e++) {
            memcpy(plain, edge + 36 * e, sizeof plain);
            /* Products with edges that are still plain: those at and after this one. */
            lanes solved[36];
            set(solved, own + 36 * v, plain, 6);
            for (int64_t u = t->product[v]; u < t->product[v + 1]; u++) {
                const int64_t left = t->update[3 * u], right = t->update[3 * u + 1], target = t->update[3 * u + 2];
                if (left != e) continue;
                if (target < 0) take_turned(own + 36 * t->later[e], plain, solved, 6);
                else {
                    lanes other[36];
                    set(other, own + 36 * v, edge + 36 * right, 6);
                    take_turned(edge + 36 * target, plain, other, 6);
                }
            }
            memcpy(edge + 36 * e, solved, sizeof solved);
        }
    }
}

/* What body v and its edges to later bodies add to y = M x, m vectors. */
static INLINE void weigh(const Task *t, const Room *w, lanes *restrict y, const lanes *restrict x, int64_t v, const int m)
{
    add(y + 6 * m * v, w->mass + 36 * v, x + 6 * m * v, m);
    for (int64_t e = t->range[v]; e < t->range[v + 1]; e++)
        if (t->heavy[e]) {
            add(y + 6 * m * v, w->mass_edge + 36 * e, x + 6 * m * t->later[e], m);
            add_turned(y + 6 * m * t->later[e], w->mass_edge + 36 * e, x + 6 * m * v, m);
        }
}

static void product(const Task *t, const Room *w, lanes *restrict y, const lanes *restrict x)
{
    const int m = (int)t->m;
    memset(y, 0, sizeof(lanes) * 6 * m * t->bodies);
    for (int64_t v = 0; v < t->bodies; v++) weigh(t, w, y, x, v, m);
}

static inline void forward(const Task *t, const Room *w, lanes *restrict y, int64_t v)
{
    const int m = (int)t->m;
    for (int64_t e = t->range[v]; e < t->range[v + 1]; e++) take_turned(y + 6 * m * t->later[e], w->edge + 36 * e, y + 6 * m * v, m);
    set(y + 6 * m * v, w->inverse + 36 * v, y + 6 * m * v, m);
}

static inline void backward(const Task *t, const Room *w, lanes *restrict y, int64_t v)
{
    const int m = (int)t->m;
    for (int64_t e = t->range[v]; e < t->range[v + 1]; e++) take(y + 6 * m * v, w->edge + 36 * e, y + 6 * m * t->later[e], m);
}

/* y = K^-1 y */
static void solve(const Task *t, const Room *w, lanes *restrict y)
{
    for (int64_t v = 0; v < t->bodies; v++) forward(t, w, y, v);
    for (int64_t v = t->bodies - 1; v >= 0; v--) backward(t, w, y, v);
}

/* old = 2 (twice K^-1 M x - x) - old, body by body, while what belongs to it is at hand; y is for use between. */
static void recur(const Task *t, const Room *w, lanes *restrict old, lanes *restrict y, const lanes *restrict x, lanes twice)
{
    const int m = (int)t->m;
    const lanes four = twice + twice;
    memset(y, 0, sizeof(lanes) * 6 * m * t->bodies);
    for (int64_t v = 0; v < t->bodies; v++) {
        weigh(t, w, y, x, v, m);
        forward(t, w, y, v);
    }
    for (int64_t v = t->bodies - 1; v >= 0; v--) {
        backward(t, w, y, v);
        for (int64_t i = 6 * m * v; i < 6 * m * (v + 1); i++) old[i] = four * y[i] - (x[i] + x[i]) - old[i];
    }
}

/* ---- Rayleigh-Ritz ---- */

/* g (m x m, lower triangle and its mirror) = x^T y, known to be symmetric. */
static void gram(int64_t n, int m, lanes *g, const lanes *restrict x, const lanes *restrict y)
{
    for (int i0 = 0; i0 < m; i0 += 3)
        for (int j0 = 0; j0 <= i0; j0 += 3) {
            const int ni = m - i0 < 3 ? m - i0 : 3, nj = m - j0 < 3 ? m - j0 : 3;
            if (ni == 3 && nj == 3) {
                lanes s[9];
                for (int k = 0; k < 9; k++) s[k] = all(0.0);
                for (int64_t r = 0; r < n; r++)
                    for (int i = 0; i < 3; i++)
                        for (int j = 0; j < 3; j++) s[3 * i + j] += x[r * m + i0 + i] * y[r * m + j0 + j];
                for (int i = 0; i < 3; i++)
                    for (int j = 0; j < 3; j++) g[(i0 + i) * m + j0 + j] = g[(j0 + j) * m + i0 + i] = s[3 * i + j];
            } else
                for (int i = i0; i < i0 + ni; i++)
                    for (int j = j0; j < j0 + nj; j++) {
                        lanes s = all(0.0);
                        for (int64_t r = 0; r < n; r++) s += x[r * m + i] * y[r * m + j];
                        g[i * m + j] = g[j * m + i] = s;
                    }
        }
}

/* Eigenvalues on the diagonal of a and vectors in v (columns), by Jacobi's rotations; those of a lane stop when they are done. */
static void jacobi(int m, lanes *a, lanes *v)
{
    for (int i = 0; i < m * m; i++) v[i] = all(i % (m + 1) ? 0.0 : 1.0);
    for (int sweep = 0; sweep < 20; sweep++) {
        int moved = 0;
        for (int p = 0; p < m - 1; p++)
            for (int q = p + 1; q < m; q++) {
                const lanes o = a[p * m + q], d = a[p * m + p], e = a[q * m + q];
                const marks turn = size_of(o) > 1e-17 * root(size_of(d * e));
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

/* Ascending lambda (m) of stiff q = lambda mass q, q^T mass q = 1, in the columns of q. */
static void small(int m, lanes *stiff, lanes *mass, lanes *values, lanes *q)
{
    lanes scale[MOST], turned[MOST * MOST];
    for (int i = 0; i < m; i++) scale[i] = 1.0 / root(stiff[i * m + i]);
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++) stiff[i * m + j] *= scale[i] * scale[j], mass[i * m + j] *= scale[i] * scale[j];
    for (int j = 0; j < m; j++) { /* Cholesky, lower */
        for (int k = 0; k < j; k++) stiff[j * m + j] -= stiff[j * m + k] * stiff[j * m + k];
        stiff[j * m + j] = root(stiff[j * m + j]);
        const lanes inverse = 1.0 / stiff[j * m + j];
        for (int i = j + 1; i < m; i++) {
            for (int k = 0; k < j; k++) stiff[i * m + j] -= stiff[i * m + k] * stiff[j * m + k];
            stiff[i * m + j] *= inverse;
        }
    }
    for (int pass = 0; pass < 2; pass++) { /* L^-1 mass L^-T */
        for (int c = 0; c < m; c++)
            for (int i = 0; i < m; i++) {
                lanes s = mass[i * m + c];
                for (int k = 0; k < i; k++) s -= stiff[i * m + k] * mass[k * m + c];
                mass[i * m + c] = s / stiff[i * m + i];
            }
        for (int i = 0; i < m; i++)
            for (int j = 0; j < m; j++) turned[j * m + i] = mass[i * m + j];
        memcpy(mass, turned, sizeof(lanes) * m * m);
    }
    for (int i = 0; i < m; i++)
        for (int j = 0; j < i; j++) mass[i * m + j] = mass[j * m + i] = 0.5 * (mass[i * m + j] + mass[j * m + i]);
    jacobi(m, mass, turned);
    for (int c = 0; c < m; c++)
        for (int i = m - 1; i >= 0; i--) {
            lanes s = turned[i * m + c];
            for (int k = i + 1; k < m; k++) s -= stiff[k * m + i] * turned[k * m + c];
            turned[i * m + c] = s / stiff[i * m + i];
        }
    for (int lane = 0; lane < WIDTH; lane++) {
        int order[MOST];
        for (int i = 0; i < m; i++) {
            int place = i;
            for (; place > 0 && mass[order[place - 1] * (m + 1)][lane] < mass[i * (m + 1)][lane]; place--) order[place] = order[place - 1];
            order[place] = i;
        }
        for (int c = 0; c < m; c++) {
            const double mu = mass[order[c] * (m + 1)][lane], norm = 1.0 / sqrt(mu);
            values[c][lane] = 1.0 / mu;
            for (int i = 0; i < m; i++) q[i * m + c][lane] = scale[i][lane] * turned[i * m + order[c]][lane] * norm;
        }
    }
}

/* y (n, m) = x q */
static void rotate(int64_t n, int m, lanes *restrict y, const lanes *restrict x, const lanes *restrict q)
{
    for (int j0 = 0; j0 < m; j0 += 3) {
        const int nj = m - j0 < 3 ? m - j0 : 3;
        for (int64_t r = 0; r < n; r += 2) /* n is even */
            if (nj == 3) {
                lanes s[6];
                for (int k = 0; k < 6; k++) s[k] = all(0.0);
                for (int i = 0; i < m; i++)
                    for (int k = 0; k < 3; k++) {
                        s[k] += x[r * m + i] * q[i * m + j0 + k];
                        s[3 + k] += x[(r + 1) * m + i] * q[i * m + j0 + k];
                    }
                for (int k = 0; k < 3; k++) y[r * m + j0 + k] = s[k], y[(r + 1) * m + j0 + k] = s[3 + k];
            } else
                for (int k = 0; k < nj; k++) {
                    lanes a = all(0.0), b = all(0.0);
                    for (int i = 0; i < m; i++) a += x[r * m + i] * q[i * m + j0 + k], b += x[(r + 1) * m + i] * q[i * m + j0 + k];
                    y[r * m + j0 + k] = a, y[(r + 1) * m + j0 + k] = b;
                }
    }
}

typedef struct { lanes values[MOST], residual[MOST], share[MOST]; } Ritz;

/* Rayleigh-Ritz on K^-1 M of the block in w->now, given M times it in w->force; shapes go to w->now, M times them to w->heavy. */
static void ritz(const Task *t, Room *w, Ritz *out)
{
    const int m = (int)t->m;
    const int64_t n = 6 * t->bodies;
    lanes before[MOST * MOST], stiff[MOST * MOST], mass[MOST * MOST], q[MOST * MOST];
    memcpy(w->ahead, w->force, sizeof(lanes) * n * m);
    solve(t, w, w->ahead);
    product(t, w, w->next, w->ahead);
    gram(n, m, before, w->now, w->force);
    gram(n, m, stiff, w->ahead, w->force);
    gram(n, m, mass, w->ahead, w->next);
    small(m, stiff, mass, out->values, q);
    for (int c = 0; c < m; c++) {
        lanes norm = all(0.0);
        for (int i = 0; i < m; i++) {
            lanes s = all(0.0);
            for (int k = 0; k < m; k++) s += before[i * m + k] * q[k * m + c];
            norm += q[i * m + c] * s;
        }
        const lanes square = 1.0 - out->values[c] * out->values[c] / norm;
        out->residual[c] = root(pick(square > 0.0, square, all(0.0)));
        out->residual[c] = pick(square == square, out->residual[c], square);
    }
    rotate(n, m, w->now, w->ahead, q);
    rotate(n, m, w->heavy, w->next, q);
    const lanes *seen = w->now + (n - 6) * m, *platform = w->number + t->inertia[t->bodies - 1];
    for (int c = 0; c < m; c++) {
        out->share[c] = all(0.0);
        for (int i = 0; i < 6; i++)
            for (int k = 0; k < 6; k++) out->share[c] += seen[i * m + c] * platform[6 * i + k] * seen[k * m + c];
    }
}

/* Chebyshev's polynomial of the shapes in w->now, into w->now; M times the result into w->force. */
static void filter(const Task *t, Room *w, const Ritz *known)
{
    const int m = (int)t->m;
    const int64_t n = 6 * t->bodies;
    const lanes outside = t->edge * known->values[m - 1], twice = outside + outside;
    memcpy(w->before, w->now, sizeof(lanes) * n * m);
    memcpy(w->force, w->heavy, sizeof(lanes) * n * m);
    solve(t, w, w->force);
    for (int64_t i = 0; i < n * m; i++) w->now[i] = twice * w->force[i] - w->before[i];
    for (int64_t step = 1; step < t->degree; step++) {
        recur(t, w, w->before, w->force, w->now, twice);
        lanes *swap = w->before;
        w->before = w->now, w->now = swap;
    }
    lanes growth[MOST];
    for (int c = 0; c < m; c++) { /* Chebyshev's recurrence at the value itself */
        const lanes ratio = 2.0 * outside / known->values[c] - 1.0, x = pick(ratio > 1.0, ratio, all(1.0));
        lanes last = all(1.0), value = x;
        for (int64_t step = 1; step < t->degree; step++) {
            const lanes following = 2.0 * x * value - last;
            last = value, value = following;
        }
        growth[c] = 1.0 / value;
    }
    for (int64_t r = 0; r < n; r++)
        for (int c = 0; c < m; c++) w->now[r * m + c] *= growth[c];
    product(t, w, w->force, w->now);
}

/* ---- single modes ---- */

/* K - shift M = L D L^T: own blocks become L below the diagonal and D^-1 on it, edges L^-1 times themselves. */
static void shifted(const Task *t, Room *w, lanes shift)
{
    lanes *own = w->other, *edge = w->other_edge;
    for (int64_t i = 0; i < 36 * t->bodies; i++) own[i] = w->stiff[i] - shift * w->mass[i];
    for (int64_t i = 0; i < 36 * t->edges; i++) edge[i] = w->stiff_edge[i] - shift * w->mass_edge[i];
    for (int64_t v = 0; v < t->bodies; v++) {
        lanes *a = own + 36 * v;
        for (int s = 0; s < 6; s++) {
            const lanes inverse = 1.0 / a[7 * s];
            for (int i = s + 1; i < 6; i++) {
                const lanes l = a[6 * i + s] * inverse;
                for (int j = s + 1; j <= i; j++) a[6 * i + j] -= l * a[6 * j + s];
            }
            for (int i = s + 1; i < 6; i++) a[6 * i + s] *= inverse;
            a[7 * s] = inverse;
        }
        for (int64_t e = t->range[v]; e < t->range[v + 1]; e++) {
            lanes *x = edge + 36 * e;
            for (int i = 1; i < 6; i++)
                for (int s = 0; s < i; s++)
                    for (int k = 0; k < 6; k++) x[6 * i + k] -= a[6 * i + s] * x[6 * s + k];
        }
        for (int64_t u = t->product[v]; u < t->product[v + 1]; u++) {
            const int64_t left = t->update[3 * u], right = t->update[3 * u + 1], target = t->update[3 * u + 2];
            const lanes *x = edge + 36 * left;
            lanes scaled[36];
            for (int i = 0; i < 36; i++) scaled[i] = a[7 * (i / 6)] * edge[36 * right + i];
            if (target >= 0) take_turned(edge + 36 * target, x, scaled, 6);
            else {
                lanes *to = own + 36 * t->later[left];
                for (int i = 0; i < 6; i++)
                    for (int j = 0; j <= i; j++) {
                        lanes sum = x[i] * scaled[j];
                        for (int r = 1; r < 6; r++) sum += x[6 * r + i] * scaled[6 * r + j];
                        to[6 * i + j] -= sum;
                    }
            }
        }
    }
}

/* x = (K - shift M)^-1 x, one vector, by what `shifted` left. */
static void solve_shifted(const Task *t, const Room *w, lanes *restrict x)
{
    for (int64_t v = 0; v < t->bodies; v++) {
        const lanes *a = w->other + 36 * v;
        lanes *b = x + 6 * v, scaled[6];
        for (int i = 1; i < 6; i++)
            for (int s = 0; s < i; s++) b[i] -= a[6 * i + s] * b[s];
        for (int i = 0; i < 6; i++) scaled[i] = a[7 * i] * b[i];
        for (int64_t e = t->range[v]; e < t->range[v + 1]; e++) take_turned(x + 6 * t->later[e], w->other_edge + 36 * e, scaled, 1);
    }
    for (int64_t v = t->bodies - 1; v >= 0; v--) {
        const lanes *a = w->other + 36 * v;
        lanes *b = x + 6 * v;
        for (int64_t e = t->range[v]; e < t->range[v + 1]; e++) take(b, w->other_edge + 36 * e, x + 6 * t->later[e], 1);
        for (int i = 0; i < 6; i++) b[i] *= a[7 * i];
        for (int i = 5; i > 0; i--)
            for (int s = 0; s < i; s++) b[s] -= a[6 * i + s] * b[i];
    }
}

/* The first `single` shapes in w->now by two steps of inverse iteration, each with a shift just below its own value; M times all into
 * w->force. What is of other modes falls like the square of the value's distance from the shift over theirs. */
static void polish(const Task *t, Room *w, const Ritz *known)
{
    const int m = (int)t->m;
    const int64_t n = 6 * t->bodies;
    lanes *x = w->next, *y = w->next + n;
    for (int c = 0; c < t->single; c++) {
        shifted(t, w, (1.0 - BESIDE) * known->values[c]);
        for (int64_t i = 0; i < n; i++) x[i] = w->heavy[i * m + c];
        solve_shifted(t, w, x);
        memset(y, 0, sizeof(lanes) * n);
        for (int64_t v = 0; v < t->bodies; v++) weigh(t, w, y, x, v, 1);
        solve_shifted(t, w, y);
        const lanes size = BESIDE * known->values[c] * BESIDE * known->values[c];
        for (int64_t i = 0; i < n; i++) w->now[i * m + c] = size * y[i];
    }
    product(t, w, w->force, w->now);
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
    const int m = (int)t->m, count = (int)t->count;
    double value[MOST], share[MOST], rho[MOST], mean[MOST], frequency[MOST], least = INFINITY;
    int group[MOST], order[MOST], taken = 0, needed = 0;
    memset(out, 0, sizeof *out);
    for (int i = 0; i < m; i++) {
        value[i] = known->values[i][lane], share[i] = known->share[i][lane], rho[i] = known->residual[i][lane];
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
    if (taken != count) return;
    const double ceiling = 4.0 * 9.86960440108935861883 * t->limit * t->limit;
    const int first = apart(value, m, needed, t->together);
    int below = first;
    while (below < m && !(left_over(t, share, below) < (below == first ? least : least - t->margin)))
        below = apart(value, m, below + 1, t->together);
    const int wide = below >= m;
    if (wide) {
        int reach = needed;
        while (reach < m && value[reach] < ceiling) reach++;
        below = apart(value, m, reach, t->together);
    }
    if (first >= m || below >= m) return;
    out->below = below, out->shift = value[below - 1] + 0.1 * (value[below] - value[below - 1]);
    if (wide) {
        if (!(ceiling <= value[below])) return;
        if (ceiling > out->shift) out->shift = ceiling;
    }
    const double inner = value[first - 1], outer = value[first];
    double spread = 0.0;
    for (int i = 0; i < first; i++) spread += rho[i] / value[i] * (rho[i] / value[i]);
    spread = sqrt(spread) * inner / outer; /* of Z, which is one product further than the residual's Y */
    for (int i = 0; i < m; i++)
        if (out->mask[i]) {
            const double gap = 1.0 / value[i] - 1.0 / outer, error = spread * spread * value[i] / gap;
            if (!((rho[i] < error ? rho[i] : error) <= t->value) || !(spread / gap <= t->angle)) return;
        }
    out->done = 1;
}

/* ---- derivatives ---- */

enum { STIFFNESS, MASS, TURN, FIRST, SECOND, INERTIA };

typedef struct { int i, j; } Pair;

static inline lanes both(const lanes *x, int m, int r, int c, Pair p)
{
    lanes s = x[r * m + p.i] * x[c * m + p.j];
    return r == c ? s : s + x[c * m + p.i] * x[r * m + p.j];
}

/* Ends' twists (12, k), forces less lambda times momenta (12, k), the twists in the stage's axes at the link (u: 3, k) of one link. */
static INLINE void link_motion(
    const Task *t, const Room *w, int64_t l, const lanes *mean, lanes *twist, lanes *force, lanes *seen, const int k)
{
    const lanes *r = w->number + t->start[2] + 9 * l, *stiff = w->number + t->start[0] + 36 * t->link[4 * l];
    const lanes *mass = w->number + t->start[1] + 144 * t->link[4 * l];
    for (int side = 0; side < 2; side++) {
        const int64_t body = t->link[4 * l + 1 + side];
        lanes *e = twist + 6 * side * k, *u = seen + 3 * side * k;
        if (body < 0) {
            memset(e, 0, sizeof(lanes) * 6 * k), memset(u, 0, sizeof(lanes) * 3 * k);
            continue;
        }
        const lanes *a = w->number + t->start[3 + side] + 3 * l, *x = w->shapes + 6 * k * body, *o = x + 3 * k;
        for (int c = 0; c < k; c++) {
            u[c] = x[c] + (a[1] * o[2 * k + c] - a[2] * o[k + c]);
            u[k + c] = x[k + c] + (a[2] * o[c] - a[0] * o[2 * k + c]);
            u[2 * k + c] = x[2 * k + c] + (a[0] * o[k + c] - a[1] * o[c]);
            for (int i = 0; i < 3; i++) {
                e[i * k + c] = r[i] * u[c] + r[3 + i] * u[k + c] + r[6 + i] * u[2 * k + c];
                e[(3 + i) * k + c] = r[i] * o[c] + r[3 + i] * o[k + c] + r[6 + i] * o[2 * k + c];
            }
        }
    }
    lanes strain[6 * MODES], momentum[12 * MODES];
    for (int i = 0; i < 6 * k; i++) strain[i] = twist[6 * k + i] - twist[i];
    memset(momentum, 0, sizeof(lanes) * 12 * k);
    set(force + 6 * k, stiff, strain, k);
    for (int p = 0; p < 2; p++)
        for (int q = 0; q < 2; q++) {
            lanes part[36];
            for (int i = 0; i < 36; i++) part[i] = mass[12 * (6 * p + i / 6) + 6 * q + i % 6];
            add(momentum + 6 * p * k, part, twist + 6 * q * k, k);
        }
    for (int i = 0; i < 6; i++)
        for (int c = 0; c < k; c++) {
            force[i * k + c] = -force[(6 + i) * k + c] - mean[c] * momentum[i * k + c];
            force[(6 + i) * k + c] -= mean[c] * momentum[(6 + i) * k + c];
        }
}

/* Adds a link's or part's share of every slot that is about it. */
static INLINE void link_slots(const Task *t, Room *w, int64_t l, const lanes *mean, const Pair *pair, const int pairs, const int k)
{
    lanes twist[12 * MODES], force[12 * MODES], seen[6 * MODES], strain[6 * MODES], world[6 * MODES];
    link_motion(t, w, l, mean, twist, force, seen, k);
    for (int i = 0; i < 6 * k; i++) strain[i] = twist[6 * k + i] - twist[i];
    const lanes *r = w->number + t->start[2] + 9 * l;
    for (int side = 0; side < 2; side++)
        for (int i = 0; i < 3; i++)
            for (int c = 0; c < k; c++) {
                const lanes *f = force + 6 * side * k;
                world[(3 * side + i) * k + c] = r[3 * i] * f[c] + r[3 * i + 1] * f[k + c] + r[3 * i + 2] * f[2 * k + c];
            }
    for (int64_t of = t->reach[l]; of < t->reach[l + 1]; of++) {
        const int64_t s = t->about[of];
        const int kind = (int)t->slot[4 * s], row = (int)t->slot[4 * s + 2], column = (int)t->slot[4 * s + 3];
        for (int p = 0; p < pairs; p++) {
            const Pair at = pairs == k ? (Pair){p, p} : pair[p]; /* no clusters: each mode with itself */
            lanes *sum = w->sum + s * pairs + p;
            if (kind == STIFFNESS) *sum += both(strain, k, row, column, at);
            else if (kind == MASS) *sum -= mean[at.i] * both(twist, k, row, column, at);
            else if (kind == TURN)
                for (int side = 0; side < 2; side++) {
                    const int64_t body = t->link[4 * l + 1 + side];
                    if (body < 0) continue;
                    const lanes *o = w->shapes + 6 * k * body + 3 * k, *u = seen + 3 * side * k, *f = force + 6 * side * k;
                    *sum += f[column * k + at.i] * u[row * k + at.j] + f[(3 + column) * k + at.i] * o[row * k + at.j];
                    *sum += f[column * k + at.j] * u[row * k + at.i] + f[(3 + column) * k + at.j] * o[row * k + at.i];
                }
            else {
                const int side = kind == SECOND, one = (row + 1) % 3, two = (row + 2) % 3;
                const int64_t body = t->link[4 * l + 1 + side];
                if (body < 0) continue;
                const lanes *o = w->shapes + 6 * k * body + 3 * k, *g = world + 3 * side * k;
                *sum += o[one * k + at.j] * g[two * k + at.i] - o[two * k + at.j] * g[one * k + at.i];
                *sum += o[one * k + at.i] * g[two * k + at.j] - o[two * k + at.i] * g[one * k + at.j];
            }
        }
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
    for (int i = 0; i < k; i++)
        for (int j = i; j < k; j++)
            if (any(same[i * k + j])) pair[pairs].i = i, pair[pairs++].j = j;
    for (int64_t i = 0; i < t->slots * pairs; i++) w->sum[i] = all(0.0);
    if (k == 6 && pairs == 6) /* the usual case, unrolled by the compiler */
        for (int64_t l = 0; l < t->links; l++) link_slots(t, w, l, mean, pair, 6, 6);
    else
        for (int64_t l = 0; l < t->links; l++) link_slots(t, w, l, mean, pair, pairs, k);
    for (int64_t s = 0; s < t->slots; s++)
        if (t->slot[4 * s] == INERTIA) {
            const lanes *x = w->shapes + 6 * k * t->slot[4 * s + 1];
            for (int p = 0; p < pairs; p++)
                w->sum[s * pairs + p] = -mean[pair[p].i] * both(x, k, (int)t->slot[4 * s + 2], (int)t->slot[4 * s + 3], pair[p]);
        }
    lanes sum[MODES * MODES];
    for (int64_t e = 0, variable = 0; variable < t->variables; variable++) {
        for (int p = 0; p < pairs; p++) sum[p] = all(0.0);
        for (; e < t->entries && t->entry[2 * e] == variable; e++) {
            const lanes change = w->change[e], *own = w->sum + t->entry[2 * e + 1] * pairs;
            for (int p = 0; p < pairs; p++) sum[p] += change * own[p];
        }
        double *to = t->slopes + variable * k * k * t->stride + design;
        for (int p = 0; p < pairs; p++) {
            const int i = pair[p].i, j = pair[p].j;
            const lanes kept = (lanes)(same[i * k + j] & (marks)sum[p]);
            store(to + (i * k + j) * t->stride, kept), store(to + (j * k + i) * t->stride, kept);
        }
    }
}

/* ---- one vector of designs ---- */

/* The modes of the lanes that are done in this round and were not before. */
static void keep(const Task *t, Room *w, const Ritz *known, const Verdict *verdict, marks fresh, lanes *value, lanes *share)
{
    const int m = (int)t->m, k = (int)t->count;
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
        for (int64_t r = 0; r < 6 * t->bodies; r++) {
            lanes *to = w->shapes + r * k + c;
            if (alike) *to = pick(fresh, w->now[r * m + first], *to);
            else
                for (int lane = 0; lane < WIDTH; lane++)
                    if (fresh[lane]) (*to)[lane] = w->now[r * m + from[lane]][lane];
        }
    }
}

static void designs(const Task *t, Room *w, int64_t design)
{
    const int64_t n = 6 * t->bodies, m = t->m;
    Verdict verdict[WIDTH];
    Ritz known;
    lanes value[MODES], share[MODES], negative, least, shift = all(0.0);
    int left = WIDTH;
    assemble(t, w);
    memcpy(w->inverse, w->stiff, sizeof(lanes) * 36 * t->bodies);
    memcpy(w->edge, w->stiff_edge, sizeof(lanes) * 36 * t->edges);
    eliminate(t, w->inverse, w->edge, &negative, &least);
    const marks firm = least > t->pivot;
    for (int64_t i = 0; i < n * m; i++) w->now[i] = all(t->block[i]);
    for (int i = 0; i < t->count; i++) value[i] = all(1.0), share[i] = all(0.0);
    if (t->variables) memset(w->shapes, 0, sizeof(lanes) * n * t->count);
    for (int lane = 0; lane < WIDTH; lane++) verdict[lane].done = 0;
    product(t, w, w->force, w->now);
    for (int64_t round = 0; round <= t->rounds && left; round++) {
        if (round == 1 && t->single) polish(t, w, &known);
        else if (round) filter(t, w, &known);
        ritz(t, w, &known);
        marks fresh = {0};
        left = 0;
        for (int lane = 0; lane < WIDTH; lane++) {
            if (verdict[lane].done) continue;
            judge(t, &known, lane, &verdict[lane]);
            if (verdict[lane].done) fresh[lane] = -1, shift[lane] = verdict[lane].shift;
            else if (firm[lane]) left++;
        }
        if (any(fresh)) keep(t, w, &known, verdict, fresh, value, share);
    }
    for (int64_t i = 0; i < 36 * t->bodies; i++) w->other[i] = w->stiff[i] - shift * w->mass[i];
    for (int64_t i = 0; i < 36 * t->edges; i++) w->other_edge[i] = w->stiff_edge[i] - shift * w->mass_edge[i];
    eliminate(t, w->other, w->other_edge, &negative, &least);
    for (int lane = 0; lane < WIDTH; lane++)
        t->good[design + lane] = firm[lane] && verdict[lane].done && negative[lane] == (double)verdict[lane].below;
    for (int i = 0; i < t->count; i++)
        store(t->values + i * t->stride + design, value[i]), store(t->share + i * t->stride + design, share[i]);
    if (t->variables) derive(t, w, design, value);
}

/* The numbers (rows of `from`) of AHEAD vectors of designs, vector by vector. */
static void gather(lanes *to, const double *from, int64_t rows, int64_t stride, int64_t design, int64_t designs)
{
    for (int64_t i = 0; i < rows; i++)
        for (int64_t k = 0; k < AHEAD && design + k * WIDTH < designs; k++)
            to[k * rows + i] = load_at(from + i * stride, design + k * WIDTH, designs);
}

int64_t flexstage_width(void) { return WIDTH; }

/* Every design of the task; 0, or 1 where that is too much. */
int64_t flexstage_modes(const Task *t)
{
    const int64_t own = 36 * t->bodies, edge = 36 * t->edges, block = 6 * t->bodies * t->m, pairs = t->count * (t->count + 1) / 2;
    const int64_t sizes[] = {AHEAD * t->numbers, AHEAD * t->entries, own, edge, own, edge, own, edge, own, edge, block, block, block, block, block, block,
                             6 * t->bodies * t->count, t->slots * pairs};
    const int count = sizeof sizes / sizeof *sizes;
    int64_t total = 0;
    for (int i = 0; i < count; i++) total += sizes[i] + 1;
    if (t->m > MOST || t->count > MODES) return 1;
    lanes *memory = aligned_alloc(sizeof(lanes), sizeof(lanes) * total), *at = memory;
    if (!memory) return 1;
    Room w;
    lanes **parts[] = {&w.numbers, &w.changes, &w.stiff, &w.stiff_edge, &w.mass, &w.mass_edge, &w.inverse, &w.edge, &w.other, &w.other_edge,
                       &w.before, &w.now, &w.next, &w.force, &w.ahead, &w.heavy, &w.shapes, &w.sum};
    for (int i = 0; i < count; i++) *parts[i] = at, at += sizes[i] + 1;
    for (int64_t first = 0; first < t->designs; first += AHEAD * WIDTH) {
        gather(w.numbers, t->numbers_, t->numbers, t->numbers_stride, first, t->designs);
        gather(w.changes, t->changes, t->entries, t->slopes_stride, first, t->designs);
        for (int64_t k = 0; k < AHEAD && first + k * WIDTH < t->designs; k++) {
            w.number = w.numbers + k * t->numbers, w.change = w.changes + k * t->entries;
            designs(t, &w, first + k * WIDTH);
        }
    }
    free(memory);
    return 0;
}
