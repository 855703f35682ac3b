/* Equilibria of many load cases, several per vector: the same steps as in element.py, condense.py, graph.py and newton.py, which explain
 * them. A "lane" is one case. Lanes are independent, so that results do not depend, to the bit, on the other cases of a call. A lane whose
 * case is finished takes the next one.
 *
 * Two steps have another order than in numpy. The plate fields, which have least energy after every step, are condensed with the factor of
 * their solution. Integrals along a flexure use rotated modes, each of which is one column of the rotation times a function of position:
 * double integrals are summed once per point, not once per pair of points (docs/nonlinear.md, 7).
 */
#include "lanes.h"

#define POINTS 24 /* maximum points along a flexure */
#define MODES 48  /* maximum curvature modes */
#define FIELDS 24 /* maximum plate field modes */

typedef double scalar __attribute__((may_alias));

typedef struct {
    int64_t links, points, twist, across, bending, fields;
    const double *weights, *running, *steps, *left; /* of the rule; left: 1 - s at the points */
    const double *phi;                              /* links x modes x points */
    const double *inner;                            /* links x modes x 3 (points + 1) */
    const double *form;                             /* links x amplitudes x amplitudes */
    const double *rest;                             /* links x amplitudes: forces of natural curvatures */
    const double *plate;                            /* links x points x 2 x fields */
    const double *compliance;                       /* links x points x 3 */
    const double *scalar; /* links x 7: length, rigidity, trapeze, stretch of P2 and P4, weight per gravity, largest stiffness */
    const int64_t *joins; /* links x 2: bodies, the ground last */
    const double *turn, *first, *second; /* links x 9, 3, 3: nominal start frame and arms */
    double *strain, *wrench;             /* links x cases x amplitudes, links x cases x 6 */
} Group;

typedef struct {
    int64_t cases, bodies, extra, groups, dead, iterations, heavy;
    double size, reach, step, gap, limit;
    const Group *group;
    double *position, *turn, *held; /* cases x (bodies + 1) x 3, x 9; cases x extra */
    const double *gravity;          /* cases x 3 */
    const int64_t *body;            /* dead: the body of each load point */
    const double *arm, *force;      /* dead x 3; cases x dead x 6 */
    const double *residual, *stiffness; /* terms of other links and fixed coordinates: cases x n, cases x n x n; or none */
    int64_t *status, *count;            /* cases: 0 converged, 1 not, 2 singular; iterations */
    double *moved, *lack;               /* cases: the last step, the last residual inside flexures */
} Task;

/* ---- lanes ---- */

static inline lanes larger(lanes a, lanes b) { return pick(a > b, a, b); }
static inline int none(marks m) { return !any(m); }

static inline void cross(lanes *r, const lanes *a, const lanes *b)
{
    r[0] = a[1] * b[2] - a[2] * b[1], r[1] = a[2] * b[0] - a[0] * b[2], r[2] = a[0] * b[1] - a[1] * b[0];
}

static inline void rotate(lanes *r, const lanes *m, const lanes *v)
{
    for (int i = 0; i < 3; i++) r[i] = m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2];
}

static inline void rotate_back(lanes *r, const lanes *m, const lanes *v)
{
    for (int i = 0; i < 3; i++) r[i] = m[i] * v[0] + m[3 + i] * v[1] + m[6 + i] * v[2];
}

/* r = a b; r = a b^T; r = a [b]x; r = [a]x b, all 3x3 */
static inline void times(lanes *r, const lanes *a, const lanes *b)
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) r[3 * i + k] = a[3 * i] * b[k] + a[3 * i + 1] * b[3 + k] + a[3 * i + 2] * b[6 + k];
}

static inline void times_turned(lanes *r, const lanes *a, const lanes *b)
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) r[3 * i + k] = a[3 * i] * b[3 * k] + a[3 * i + 1] * b[3 * k + 1] + a[3 * i + 2] * b[3 * k + 2];
}

static inline void times_hat(lanes *r, const lanes *a, const lanes *b)
{
    for (int i = 0; i < 3; i++) {
        r[3 * i] = a[3 * i + 1] * b[2] - a[3 * i + 2] * b[1];
        r[3 * i + 1] = a[3 * i + 2] * b[0] - a[3 * i] * b[2];
        r[3 * i + 2] = a[3 * i] * b[1] - a[3 * i + 1] * b[0];
    }
}

static inline void hat_times(lanes *r, const lanes *a, const lanes *b)
{
    for (int k = 0; k < 3; k++) {
        r[k] = a[1] * b[6 + k] - a[2] * b[3 + k];
        r[3 + k] = a[2] * b[k] - a[0] * b[6 + k];
        r[6 + k] = a[0] * b[3 + k] - a[1] * b[k];
    }
}

/* exp [v]x: by series up to an angle of 1.5, else by the C library. */
static void exponential(lanes *r, const lanes *v)
{
    const lanes x = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    lanes one = all(1.0), two = all(1.0);
    for (int k = 12; k > 0; k--) {
        one = 1.0 - one * x * (1.0 / (2.0 * k * (2.0 * k + 1.0)));
        two = 1.0 - two * x * (1.0 / ((2.0 * k + 1.0) * (2.0 * k + 2.0)));
    }
    two = 0.5 * two;
    if (any(x > 2.25))
        for (int i = 0; i < WIDTH; i++)
            if (x[i] > 2.25) {
                const double angle = sqrt(x[i]), half = sin(0.5 * angle) / angle;
                one[i] = sin(angle) / angle, two[i] = 2.0 * half * half;
            }
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) r[3 * i + k] = two * v[i] * v[k];
    for (int i = 0; i < 3; i++) r[4 * i] += 1.0 - two * x;
    r[1] -= one * v[2], r[2] += one * v[1], r[5] -= one * v[0];
    r[3] += one * v[2], r[6] -= one * v[1], r[7] += one * v[0];
}

static void logarithm(lanes *v, const lanes *r)
{
    v[0] = 0.5 * (r[7] - r[5]), v[1] = 0.5 * (r[2] - r[6]), v[2] = 0.5 * (r[3] - r[1]);
    const lanes cosine = 0.5 * (r[0] + r[4] + r[8] - 1.0), x = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    lanes factor = 1.0 + x * (1.0 / 6.0 + x * (3.0 / 40.0 + x * (5.0 / 112.0 + x * (35.0 / 1152.0))));
    const marks small = (x < 1e-4) & (cosine > 0.0);
    if (any(~small))
        for (int i = 0; i < WIDTH; i++)
            if (!small[i]) {
                const double sine = sqrt(x[i] < 1e-16 ? 1.0 : x[i]);
                factor[i] = 2.0 * atan(sine / (1.0 + cosine[i])) / sine;
            }
    for (int i = 0; i < 3; i++) v[i] *= factor;
}

/* ---- linear systems ---- */

/* a (n, n + m) by rows gets the solutions in its last m columns: Crout's order, with row exchanges per lane. */
static void exchange(lanes *a, int wide, int s, marks where)
{
    const marks here = where - where + s;
    if (none(where ^ here)) return;
    if (none(where ^ (where - where + where[0]))) {
        lanes *one = a + (int64_t)s * wide, *other = a + (int64_t)where[0] * wide;
        for (int c = 0; c < wide; c++) {
            const lanes t = one[c];
            one[c] = other[c], other[c] = t;
        }
        return;
    }
    for (int i = 0; i < WIDTH; i++)
        if (where[i] != s) {
            scalar *one = (scalar *)(a + (int64_t)s * wide) + i, *other = (scalar *)(a + where[i] * wide) + i;
            for (int c = 0; c < wide * WIDTH; c += WIDTH) {
                const double t = one[c];
                one[c] = other[c], other[c] = t;
            }
        }
}

static void solve(lanes *restrict a, int n, int m)
{
    const int wide = n + m;
    for (int s = 0; s < n; s++) {
        int r = s;
        for (; r + 4 <= n; r += 4) {
            lanes *p = a + (int64_t)r * wide, x0 = p[s], x1 = p[wide + s], x2 = p[2 * wide + s], x3 = p[3 * wide + s];
            for (int t = 0; t < s; t++) {
                const lanes u = a[t * wide + s];
                x0 -= p[t] * u, x1 -= p[wide + t] * u, x2 -= p[2 * wide + t] * u, x3 -= p[3 * wide + t] * u;
            }
            p[s] = x0, p[wide + s] = x1, p[2 * wide + s] = x2, p[3 * wide + s] = x3;
        }
        for (; r < n; r++) {
            lanes *p = a + (int64_t)r * wide, x0 = p[s];
            for (int t = 0; t < s; t++) x0 -= p[t] * a[t * wide + s];
            p[s] = x0;
        }
        lanes best = size_of(a[s * wide + s]);
        marks where = (marks)best - (marks)best + s;
        for (int row = s + 1; row < n; row++) {
            const lanes value = size_of(a[row * wide + s]);
            const marks better = value > best;
            best = pick(better, value, best);
            where = (better & (where - where + row)) | (~better & where);
        }
        exchange(a, wide, s, where);
        lanes *own = a + (int64_t)s * wide;
        const lanes inverse = 1.0 / own[s];
        for (int row = s + 1; row < n; row++) a[row * wide + s] *= inverse;
        own[s] = inverse;
        int c = s + 1;
        for (; c + 4 <= wide; c += 4) {
            lanes x0 = own[c], x1 = own[c + 1], x2 = own[c + 2], x3 = own[c + 3];
            for (int t = 0; t < s; t++) {
                const lanes l = own[t], *u = a + (int64_t)t * wide + c;
                x0 -= l * u[0], x1 -= l * u[1], x2 -= l * u[2], x3 -= l * u[3];
            }
            own[c] = x0, own[c + 1] = x1, own[c + 2] = x2, own[c + 3] = x3;
        }
        for (; c < wide; c++) {
            lanes x0 = own[c];
            for (int t = 0; t < s; t++) x0 -= own[t] * a[t * wide + c];
            own[c] = x0;
        }
    }
    for (int r = n - 1; r >= 0; r--) {
        lanes *own = a + (int64_t)r * wide;
        int c = n;
        for (; c + 4 <= wide; c += 4) {
            lanes x0 = own[c], x1 = own[c + 1], x2 = own[c + 2], x3 = own[c + 3];
            for (int t = r + 1; t < n; t++) {
                const lanes l = own[t], *u = a + (int64_t)t * wide + c;
                x0 -= l * u[0], x1 -= l * u[1], x2 -= l * u[2], x3 -= l * u[3];
            }
            own[c] = x0 * own[r], own[c + 1] = x1 * own[r], own[c + 2] = x2 * own[r], own[c + 3] = x3 * own[r];
        }
        for (; c < wide; c++) {
            lanes x0 = own[c];
            for (int t = r + 1; t < n; t++) x0 -= own[t] * a[t * wide + c];
            own[c] = x0 * own[r];
        }
    }
}

/* ---- one flexure ---- */

/* Tables of a flexure that are computed once, and arrays of its cases. */
typedef struct {
    const Group *group;
    int number, modes, amplitudes, columns;
    const double *phi, *inner, *form, *rest, *plate, *compliance, *scalar, *turn, *first, *second;
    int64_t one, other;
    double *paths;  /* points x modes x points: running integrals of each mode */
    double *pairs;  /* points x fields (fields + 1) / 2: stretching of pairs of fields, weights included */
    lanes *strain;  /* amplitudes */
    lanes wrench[6];
    lanes *curvature; /* points x 3 */
    lanes *factor;    /* fields x fields: unit lower factor, inverse pivots */
    lanes *fields;    /* fields x modes: fields per curvature */
    lanes *answer;    /* (modes + 6) x columns */
    lanes frame[9], lever[3], arm[3], weight[3], onset[3], mean[27], middle[3], lack;
} Flexure;

/* Work arrays of one flexure. */
typedef struct {
    lanes *turned, *carried, *work; /* points x 3 x modes */
    lanes *matrix;                  /* (modes + 6) x (modes + 6 + columns) */
    lanes *steep;                   /* modes x fields */
    lanes gradient[MODES + FIELDS];
} Scratch;

static void curve(const Flexure *f)
{
    const int n = (int)f->group->points, ends[4] = {0, (int)f->group->twist, (int)(f->group->twist + f->group->across), f->modes};
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < n; i++) {
            lanes s = all(0.0);
            for (int k = ends[axis]; k < ends[axis + 1]; k++) s += f->phi[k * n + i] * f->strain[k];
            f->curvature[3 * i + axis] = s;
        }
}

/* Fields of least energy at the curvatures, and the factor of their matrix. */
static void settle(Flexure *f)
{
    const int n = (int)f->group->points, e = (int)f->group->fields, q = f->amplitudes, k0 = f->modes, pair = e * (e + 1) / 2;
    curve(f);
    if (!e) return;
    lanes square[POINTS], load[POINTS], right[FIELDS], *m = f->factor;
    for (int i = 0; i < n; i++) {
        const lanes twist = f->curvature[3 * i], bend = f->curvature[3 * i + 2];
        square[i] = bend * bend, load[i] = f->group->weights[i] * f->scalar[3] * bend * twist * twist;
    }
    for (int a = 0, p = 0; a < e; a++)
        for (int b = 0; b <= a; b++, p++) {
            lanes s = all(f->form[(k0 + a) * q + k0 + b]);
            for (int i = 0; i < n; i++) s += f->pairs[i * pair + p] * square[i];
            m[a * e + b] = s;
        }
    for (int a = 0; a < e; a++) {
        lanes s = all(f->rest[k0 + a]);
        for (int i = 0; i < n; i++) s += f->plate[2 * i * e + a] * load[i];
        for (int k = 0; k < k0; k++) s -= f->form[k * q + k0 + a] * f->strain[k];
        right[a] = s;
    }
    for (int a = 0; a < e; a++) {
        for (int b = 0; b < a; b++) {
            lanes s = m[a * e + b];
            for (int c = 0; c < b; c++) s -= m[a * e + c] * m[b * e + c];
            m[a * e + b] = s; /* L D so far */
        }
        lanes pivot = m[a * e + a];
        for (int b = 0; b < a; b++) {
            const lanes ld = m[a * e + b];
            m[a * e + b] = ld * m[b * e + b];
            pivot -= ld * m[a * e + b];
        }
        m[a * e + a] = 1.0 / pivot;
    }
    for (int a = 0; a < e; a++)
        for (int b = 0; b < a; b++) right[a] -= m[a * e + b] * right[b];
    for (int a = e - 1; a >= 0; a--) {
        right[a] *= m[a * e + a];
        for (int b = a + 1; b < e; b++) right[a] -= m[b * e + a] * right[b];
        f->strain[k0 + a] = right[a];
    }
}

/* Rotations at the points (n + 1 of them, the end last). */
static void turns(const Flexure *f, lanes *turn)
{
    const int n = (int)f->group->points, p = 3 * (n + 1);
    const int ends[4] = {0, (int)f->group->twist, (int)(f->group->twist + f->group->across), f->modes};
    const double root = sqrt(15.0) / 3.0;
    for (int i = 0; i <= n; i++) {
        lanes k[9];
        for (int axis = 0; axis < 3; axis++)
            for (int j = 0; j < 3; j++) {
                lanes s = all(0.0);
                for (int mode = ends[axis]; mode < ends[axis + 1]; mode++) s += f->inner[mode * p + 3 * i + j] * f->strain[mode];
                k[3 * j + axis] = s;
            }
        const double h = f->group->steps[i];
        lanes one[3], two[3], three[3], bracket[3], inside[3], outer[3], v[3], step[9];
        for (int c = 0; c < 3; c++) {
            one[c] = h * k[3 + c], two[c] = root * h * (k[6 + c] - k[c]);
            three[c] = 10.0 / 3.0 * h * (k[6 + c] - 2.0 * k[3 + c] + k[c]);
        }
        cross(bracket, two, one);
        for (int c = 0; c < 3; c++) outer[c] = 2.0 * three[c] + bracket[c];
        cross(inside, outer, one);
        for (int c = 0; c < 3; c++) inside[c] = two[c] - inside[c] * (1.0 / 60.0), outer[c] = bracket[c] - 20.0 * one[c] - three[c];
        cross(v, inside, outer);
        for (int c = 0; c < 3; c++) v[c] = one[c] + three[c] * (1.0 / 12.0) + v[c] * (1.0 / 240.0);
        if (!i) exponential(turn, v);
        else {
            exponential(step, v);
            times(turn + 9 * i, turn + 9 * (i - 1), step);
        }
    }
}

/* Stretching by Gaussian curvature: weighted first derivatives by k_x and k_z at the points; second derivatives added to the matrix. */
static void stretch(Flexure *f, Scratch *s, lanes *first)
{
    const int n = (int)f->group->points, e = (int)f->group->fields, q = f->amplitudes, k0 = f->modes, x = (int)f->group->twist;
    const int z = x + (int)f->group->across, wide = k0 + 6 + f->columns;
    lanes *a = s->matrix, along[3][POINTS], sideways[2 * POINTS * FIELDS];
    for (int i = 0; i < n; i++) {
        const double w = f->group->weights[i], stiff = w * f->scalar[3], stiff_four = w * f->scalar[4];
        const lanes twist = f->curvature[3 * i], bend = f->curvature[3 * i + 2];
        lanes two = all(0.0), four = all(0.0);
        for (int c = 0; c < e; c++) {
            two += f->plate[2 * i * e + c] * f->strain[k0 + c];
            four += f->plate[(2 * i + 1) * e + c] * f->strain[k0 + c];
        }
        const lanes curved = stiff * (twist * twist - bend * two);
        first[3 * i] = 2.0 * curved * twist, first[3 * i + 1] = all(0.0), first[3 * i + 2] = stiff_four * bend * four * four - curved * two;
        along[0][i] = 4.0 * stiff * twist * twist + 2.0 * curved;
        along[1][i] = -2.0 * stiff * twist * two;
        along[2][i] = stiff * two * two + stiff_four * four * four;
        const lanes one = -2.0 * stiff * twist * bend, other = stiff * two * bend - curved, last = 2.0 * stiff_four * bend * four;
        for (int c = 0; c < e; c++) {
            sideways[i * e + c] = f->plate[2 * i * e + c] * one;
            sideways[(n + i) * e + c] = f->plate[2 * i * e + c] * other + f->plate[(2 * i + 1) * e + c] * last;
        }
    }
    const int from[3] = {0, 0, z}, to[3] = {x, x, k0}, start[3] = {0, z, z}, stop[3] = {x, k0, k0};
    for (int block = 0; block < 3; block++)
        for (int k = from[block]; k < to[block]; k++) {
            lanes row[POINTS];
            for (int i = 0; i < n; i++) row[i] = f->phi[k * n + i] * along[block][i];
            for (int l = block == 1 ? start[block] : k; l < stop[block]; l++) {
                lanes t = all(0.0);
                for (int i = 0; i < n; i++) t += f->phi[l * n + i] * row[i];
                a[k * wide + l] += t;
                if (l != k) a[l * wide + k] += t;
            }
        }
    if (!e) return;
    for (int k = 0; k < k0; k++) {
        if (k == x) k = z;
        if (k >= k0) break;
        const lanes *from_points = sideways + (k < x ? 0 : n * e);
        lanes *steep = s->steep + k * e, *follow = f->fields + k * e;
        for (int c = 0; c < e; c++) {
            lanes t = all(f->form[k * q + k0 + c]);
            for (int i = 0; i < n; i++) t += f->phi[k * n + i] * from_points[i * e + c];
            steep[c] = t;
        }
        for (int c = 0; c < e; c++)
            for (int b = 0; b < c; b++) steep[c] -= f->factor[c * e + b] * steep[b];
        for (int c = 0; c < e; c++) follow[c] = steep[c] * f->factor[c * e + c];
        for (int l = 0; l <= k; l++) {
            if (l == x) l = z;
            if (l > k) break;
            lanes t = all(0.0);
            for (int c = 0; c < e; c++) t += s->steep[l * e + c] * follow[c];
            a[k * wide + l] -= t;
            if (l != k) a[l * wide + k] -= t;
        }
        for (int c = e - 1; c >= 0; c--)
            for (int b = c + 1; b < e; b++) follow[c] -= f->factor[b * e + c] * follow[b];
    }
}

/* Residual and matrix of a flexure at its amplitudes, end force and moment, solved for its end motions; gap: distance of the end. */
static lanes condense(Flexure *f, Scratch *s, const lanes *wanted, const lanes *wanted_turn, int heavy)
{
    const Group *g = f->group;
    const int n = (int)g->points, q = f->amplitudes, k0 = f->modes, e = (int)g->fields, x = (int)g->twist, columns = f->columns;
    const int wide = k0 + 6 + columns, size = k0 + 6, ends[4] = {0, x, x + (int)g->across, k0};
    const double trapeze = f->scalar[2];
    lanes turn[9 * (POINTS + 1)], rate[3 * POINTS], place[3 * POINTS], force[3 * POINTS], moment[3 * POINTS], soft[6 * POINTS];
    lanes tension[POINTS], first[3 * POINTS], end[3], *a = s->matrix;
    settle(f);
    turns(f, turn);
    /* configuration */
    for (int c = 0; c < 3; c++) end[c] = all(0.0), f->middle[c] = all(0.0);
    for (int i = 0; i < n; i++) {
        const double *c = f->compliance + 3 * i;
        const lanes *r = turn + 9 * i, twist = f->curvature[3 * i];
        lanes local[3];
        for (int d = 0; d < 3; d++) force[3 * i + d] = heavy ? f->wrench[d] + g->left[i] * f->weight[d] : f->wrench[d];
        rotate_back(local, r, force + 3 * i);
        tension[i] = local[0];
        for (int d = 0; d < 3; d++) local[d] *= c[d];
        local[0] += 1.0 - 0.5 * trapeze * twist * twist;
        rotate(rate + 3 * i, r, local);
        for (int row = 0, p = 0; row < 3; row++)
            for (int col = row; col < 3; col++, p++)
                soft[6 * i + p] = c[0] * r[3 * row] * r[3 * col] + c[1] * r[3 * row + 1] * r[3 * col + 1] + c[2] * r[3 * row + 2] * r[3 * col + 2];
        for (int d = 0; d < 3; d++) end[d] += g->weights[i] * rate[3 * i + d];
        if (heavy)
            for (int d = 0; d < 3; d++) f->middle[d] += g->weights[i] * g->left[i] * rate[3 * i + d];
    }
    if (!heavy)
        for (int i = 0; i < n; i++) {
            lanes lever[3];
            for (int d = 0; d < 3; d++) {
                lanes t = end[d];
                for (int j = 0; j < n; j++) t -= g->running[i * n + j] * rate[3 * j + d];
                lever[d] = t;
            }
            cross(moment + 3 * i, lever, f->wrench);
        }
    else {
        for (int i = 0; i < n; i++) cross(place + 3 * i, rate + 3 * i, force + 3 * i);
        for (int i = 0; i < n; i++)
            for (int d = 0; d < 3; d++) {
                lanes t = all(0.0);
                for (int j = 0; j < n; j++) t += (g->weights[j] - g->running[i * n + j]) * place[3 * j + d];
                moment[3 * i + d] = t;
            }
    }
    for (int i = 0; i < n; i++)
        for (int d = 0; d < 3; d++) moment[3 * i + d] += f->wrench[3 + d];
    /* matrix: elastic part */
    for (int k = 0; k < k0; k++)
        for (int l = 0; l < k0; l++) a[k * wide + l] = all(f->form[k * q + l]);
    const int stiffened = f->scalar[3] != 0.0 || f->scalar[4] != 0.0 || e;
    if (stiffened) stretch(f, s, first);
    else
        for (int i = 0; i < 3 * n; i++) first[i] = all(0.0);
    /* gradient */
    for (int i = 0; i < n; i++) {
        lanes bending[3];
        rotate_back(bending, turn + 9 * i, moment + 3 * i);
        bending[0] -= trapeze * tension[i] * f->curvature[3 * i];
        for (int d = 0; d < 3; d++) first[3 * i + d] -= g->weights[i] * bending[d];
    }
    lanes largest = all(0.0);
    for (int axis = 0; axis < 3; axis++)
        for (int k = ends[axis]; k < ends[axis + 1]; k++) {
            lanes t = all(-f->rest[k]);
            for (int l = ends[axis]; l < ends[axis + 1]; l++) t += f->form[k * q + l] * f->strain[l];
            for (int c = k0; c < q; c++) t += f->form[k * q + c] * f->strain[c];
            for (int i = 0; i < n; i++) t += f->phi[k * n + i] * first[3 * i + axis];
            s->gradient[k] = t;
            largest = larger(size_of(t), largest);
        }
    largest *= 1.0 / f->scalar[6];
    /* rotation and displacement of points by the amplitudes: turned and carried, points x 3 x modes */
    for (int axis = 0; axis < 3; axis++)
        for (int d = 0; d < 3; d++) {
            lanes column[POINTS];
            for (int j = 0; j < n; j++) column[j] = turn[9 * j + 3 * d + axis];
            for (int k = ends[axis]; k < ends[axis + 1]; k++) {
                const double *path = f->paths + (int64_t)k * n * n, *own = f->phi + k * n;
                lanes t = all(0.0);
                for (int j = 0; j < n; j++) t += (g->weights[j] * own[j]) * column[j];
                a[(k0 + 3 + d) * wide + k] = t;
                a[k * wide + k0 + 3 + d] = -t;
                int i = 0;
                for (; i + 2 <= n; i += 2) {
                    lanes one = all(0.0), other = all(0.0);
                    for (int j = 0; j < n; j++) one += path[i * n + j] * column[j], other += path[(i + 1) * n + j] * column[j];
                    s->turned[(3 * i + d) * k0 + k] = one, s->turned[(3 * i + 3 + d) * k0 + k] = other;
                }
                for (; i < n; i++) {
                    lanes one = all(0.0);
                    for (int j = 0; j < n; j++) one += path[i * n + j] * column[j];
                    s->turned[(3 * i + d) * k0 + k] = one;
                }
            }
        }
    for (int i = 0; i < n; i++) {
        const lanes *p = soft + 6 * i, *r = turn + 9 * i, *v = rate + 3 * i, *h = force + 3 * i;
        const lanes whole[9] = {p[0], p[1], p[2], p[1], p[3], p[4], p[2], p[4], p[5]};
        lanes m[9], pulled[3], axis[3] = {r[0], r[3], r[6]};
        times_hat(m, whole, h);
        m[1] += v[2], m[2] -= v[1], m[3] -= v[2], m[5] += v[0], m[6] += v[1], m[7] -= v[0];
        cross(pulled, axis, h);
        const double w = g->weights[i];
        const lanes *t = s->turned + 3 * i * k0, *u = moment + 3 * i;
        lanes *y = s->carried + 3 * i * k0, *b = s->work + 3 * i * k0;
        const lanes twisted = trapeze * f->curvature[3 * i];
        for (int k = 0; k < k0; k++) {
            const lanes t0 = t[k], t1 = t[k0 + k], t2 = t[2 * k0 + k];
            lanes y0 = m[0] * t0 + m[1] * t1 + m[2] * t2, y1 = m[3] * t0 + m[4] * t1 + m[5] * t2, y2 = m[6] * t0 + m[7] * t1 + m[8] * t2;
            if (k < x) {
                const lanes narrow = twisted * f->phi[k * n + i];
                y0 -= axis[0] * narrow, y1 -= axis[1] * narrow, y2 -= axis[2] * narrow;
            }
            y[k] = w * y0, y[k0 + k] = w * y1, y[2 * k0 + k] = w * y2;
            b[k] = w * (u[1] * t2 - u[2] * t1), b[k0 + k] = w * (u[2] * t0 - u[0] * t2), b[2 * k0 + k] = w * (u[0] * t1 - u[1] * t0);
        }
    }
    for (int d = 0; d < 3; d++)
        for (int k = 0; k < k0; k++) {
            lanes t = all(0.0);
            for (int i = 0; i < n; i++) t += s->carried[(3 * i + d) * k0 + k];
            a[(k0 + d) * wide + k] = t, a[k * wide + k0 + d] = -t;
        }
    if (heavy)
        for (int d = 0; d < 3; d++)
            for (int k = 0; k < k0; k++) {
                lanes t = all(0.0);
                for (int i = 0; i < n; i++) t += g->left[i] * s->carried[(3 * i + d) * k0 + k];
                a[k * wide + size + 7 + d] = t;
            }
    /* geometric part: rows of modes in section axes, integrals from each point to the end */
    for (int k = 0; k < k0; k++)
        for (int d = 0; d < 3; d++) {
            lanes beyond[POINTS];
            const int one = (d + 1) % 3, other = (d + 2) % 3;
            for (int i = 0; i < n; i++)
                beyond[i] = force[3 * i + one] * s->carried[(3 * i + other) * k0 + k] - force[3 * i + other] * s->carried[(3 * i + one) * k0 + k];
            int j = 0;
            for (; j + 2 <= n; j += 2) {
                lanes t0 = s->work[(3 * j + d) * k0 + k], t1 = s->work[(3 * j + 3 + d) * k0 + k];
                for (int i = 0; i < n; i++) t0 -= g->running[i * n + j] * beyond[i], t1 -= g->running[i * n + j + 1] * beyond[i];
                s->work[(3 * j + d) * k0 + k] = t0, s->work[(3 * j + 3 + d) * k0 + k] = t1;
            }
            for (; j < n; j++) {
                lanes t0 = s->work[(3 * j + d) * k0 + k];
                for (int i = 0; i < n; i++) t0 -= g->running[i * n + j] * beyond[i];
                s->work[(3 * j + d) * k0 + k] = t0;
            }
        }
    for (int l = 0; l < k0; l++) {
        lanes local[3 * POINTS];
        for (int i = 0; i < n; i++) {
            const lanes *r = turn + 9 * i, *h = force + 3 * i, *t = s->turned + 3 * i * k0 + l;
            const lanes v[3] = {s->work[3 * i * k0 + l], s->work[(3 * i + 1) * k0 + l], s->work[(3 * i + 2) * k0 + l]};
            lanes back[3], axis[3] = {r[0], r[3], r[6]}, pulled[3];
            rotate_back(back, r, v);
            cross(pulled, axis, h);
            lanes pull = f->curvature[3 * i] * (pulled[0] * t[0] + pulled[1] * t[k0] + pulled[2] * t[2 * k0]);
            if (l < x) pull += tension[i] * f->phi[l * n + i];
            back[0] -= g->weights[i] * trapeze * pull;
            local[i] = back[0], local[n + i] = back[1], local[2 * n + i] = back[2];
        }
        for (int axis = 0; axis < 3; axis++) {
            const lanes *v = local + axis * n;
            int k = ends[axis];
            for (; k + 2 <= ends[axis + 1]; k += 2) {
                const double *one = f->phi + k * n, *other = one + n;
                lanes t0 = all(0.0), t1 = all(0.0);
                for (int i = 0; i < n; i++) t0 += one[i] * v[i], t1 += other[i] * v[i];
                a[k * wide + l] -= t0, a[(k + 1) * wide + l] -= t1;
            }
            for (; k < ends[axis + 1]; k++) {
                lanes t0 = all(0.0);
                for (int i = 0; i < n; i++) t0 += f->phi[k * n + i] * v[i];
                a[k * wide + l] -= t0;
            }
        }
    }
    /* the end */
    lanes whole[6], sways[12], gap[6], lies[9];
    for (int p = 0; p < 6; p++) {
        whole[p] = sways[p] = sways[6 + p] = all(0.0);
        for (int i = 0; i < n; i++) {
            const double w = g->weights[i], left = g->left[i];
            whole[p] += w * soft[6 * i + p];
            if (heavy) sways[p] += w * left * soft[6 * i + p], sways[6 + p] += w * left * left * soft[6 * i + p];
        }
    }
    static const int at[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    for (int row = 0; row < 6; row++)
        for (int col = 0; col < 6; col++)
            a[(k0 + row) * wide + k0 + col] = row < 3 && col < 3 ? whole[at[3 * row + col]] : all(0.0);
    times_turned(lies, turn + 9 * n, wanted_turn);
    logarithm(gap + 3, lies);
    for (int c = 0; c < 3; c++) gap[c] = end[c] - wanted[c];
    for (int c = 0; c < 6; c++) largest = larger(size_of(gap[c]), largest);
    for (int k = 0; k < k0; k++) {
        a[k * wide + size] = -s->gradient[k];
        for (int c = 1; c < 7; c++) a[k * wide + size + c] = all(0.0);
    }
    for (int row = 0; row < 6; row++) {
        lanes *own = a + (k0 + row) * wide + size;
        own[0] = -gap[row];
        for (int c = 1; c < 7; c++) own[c] = all(c == row + 1 ? 1.0 : 0.0);
        if (heavy)
            for (int c = 0; c < 3; c++) own[7 + c] = row < 3 ? -sways[at[3 * row + c]] : all(0.0);
    }
    lanes hung[3 * MODES];
    if (heavy)
        for (int d = 0; d < 3; d++)
            for (int k = 0; k < k0; k++) hung[d * k0 + k] = a[k * wide + size + 7 + d];
    solve(a, size, columns);
    for (int r = 0; r < size; r++)
        for (int c = 0; c < columns; c++) f->answer[r * columns + c] = a[r * wide + size + c];
    if (heavy) /* mean position by the end motions and by the weight */
        for (int d = 0; d < 3; d++)
            for (int c = 0; c < 9; c++) {
                lanes t = c < 6 ? all(0.0) : sways[6 + at[3 * d + c - 6]];
                for (int k = 0; k < k0; k++) t += hung[d * k0 + k] * f->answer[k * columns + 1 + c];
                for (int b = 0; b < 3; b++) t += sways[at[3 * d + b]] * f->answer[(k0 + b) * columns + 1 + c];
                f->mean[9 * d + c] = t;
            }
    return largest;
}

/* ---- the stage ---- */

typedef struct {
    const Task *task;
    int64_t next, cases[WIDTH], at[WIDTH], done[WIDTH]; /* case of each lane, or -1; its iterations */
    int flexures, n, condensed; /* condensed: whether flexures are condensed at these amplitudes and poses */
    Flexure *flexure;
    Scratch scratch;
    lanes *position, *turn, *held, *gravity, *force, *matrix, *step;
} Stage;

static scalar *one(lanes *a, int lane) { return (scalar *)a + lane; }

static void take(Stage *s, int lane, int64_t number)
{
    const Task *t = s->task;
    const int64_t bodies = t->bodies + 1;
    s->cases[lane] = s->at[lane] = number, s->done[lane] = t->count[number];
    for (int64_t i = 0; i < 3 * bodies; i++) *one(s->position + i, lane) = t->position[number * 3 * bodies + i];
    for (int64_t i = 0; i < 9 * bodies; i++) *one(s->turn + i, lane) = t->turn[number * 9 * bodies + i];
    for (int64_t i = 0; i < t->extra; i++) *one(s->held + i, lane) = t->held[number * t->extra + i];
    for (int i = 0; i < 3; i++) *one(s->gravity + i, lane) = t->gravity[number * 3 + i];
    for (int64_t i = 0; i < 6 * t->dead; i++) *one(s->force + i, lane) = t->force[number * 6 * t->dead + i];
    for (int i = 0; i < s->flexures; i++) {
        Flexure *f = s->flexure + i;
        const int64_t row = f->number * t->cases + number;
        for (int k = 0; k < f->amplitudes; k++) *one(f->strain + k, lane) = f->group->strain[row * f->amplitudes + k];
        for (int k = 0; k < 6; k++) *one(f->wrench + k, lane) = f->group->wrench[row * 6 + k];
    }
}

static void put(Stage *s, int lane)
{
    const Task *t = s->task;
    const int64_t bodies = t->bodies + 1, number = s->cases[lane];
    for (int64_t i = 0; i < 3 * bodies; i++) t->position[number * 3 * bodies + i] = *one(s->position + i, lane);
    for (int64_t i = 0; i < 9 * bodies; i++) t->turn[number * 9 * bodies + i] = *one(s->turn + i, lane);
    for (int64_t i = 0; i < t->extra; i++) t->held[number * t->extra + i] = *one(s->held + i, lane);
    for (int i = 0; i < s->flexures; i++) {
        Flexure *f = s->flexure + i;
        const int64_t row = f->number * t->cases + number;
        for (int k = 0; k < f->amplitudes; k++) f->group->strain[row * f->amplitudes + k] = *one(f->strain + k, lane);
        for (int k = 0; k < 6; k++) f->group->wrench[row * 6 + k] = *one(f->wrench + k, lane);
    }
}

/* Add a 3x3 block to the stage's matrix. */
static void add(Stage *s, int64_t row, int64_t column, const lanes *block, double sign)
{
    const int wide = s->n + 1;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) s->matrix[(row + i) * wide + column + k] += sign * block[3 * i + k];
}

/* S_a^T k S_b, S = [1, -[arm]x; 0, 1], into the rows and columns of two bodies. */
static void add_moved(Stage *s, const lanes *k, const lanes *arm_a, const lanes *arm_b, int64_t row, int64_t column, double sign)
{
    lanes a[9], b[9], c[9], d[9], t[9], r[9];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            a[3 * i + j] = k[6 * i + j], b[3 * i + j] = k[6 * i + 3 + j], c[3 * i + j] = k[18 + 6 * i + j], d[3 * i + j] = k[21 + 6 * i + j];
    times_hat(t, a, arm_b);
    for (int i = 0; i < 9; i++) b[i] -= t[i];
    times_hat(t, c, arm_b);
    for (int i = 0; i < 9; i++) d[i] -= t[i];
    add(s, row, column, a, sign), add(s, row, column + 3, b, sign);
    hat_times(r, arm_a, a);
    for (int i = 0; i < 9; i++) c[i] += r[i];
    hat_times(r, arm_a, b);
    for (int i = 0; i < 9; i++) d[i] += r[i];
    add(s, row + 3, column, c, sign), add(s, row + 3, column + 3, d, sign);
}

static void hat(lanes *r, const lanes *v)
{
    const lanes nought = all(0.0);
    r[0] = r[4] = r[8] = nought, r[1] = -v[2], r[2] = v[1], r[3] = v[2], r[5] = -v[0], r[6] = -v[1], r[7] = v[0];
}

/* A flexure's residual and stiffness on its two bodies. */
static lanes bend(Stage *s, Flexure *f)
{
    const Task *t = s->task;
    const int wide = s->n + 1, columns = f->columns, k0 = f->modes, heavy = (int)t->heavy;
    const int64_t i6 = f->one < t->bodies ? 6 * f->one : -1, j6 = f->other < t->bodies ? 6 * f->other : -1;
    const lanes *turn = s->turn + 9 * f->one, *other = s->turn + 9 * f->other;
    const double length = f->scalar[0], unit = f->scalar[1] / length;
    lanes drawn[9], end_frame[9], wanted[3], wanted_turn[9], across[3], v[3];
    for (int i = 0; i < 9; i++) drawn[i] = all(f->turn[i]);
    times(f->frame, turn, drawn), times(end_frame, other, drawn);
    for (int i = 0; i < 3; i++) v[i] = all(f->first[i]);
    rotate(f->onset, turn, v);
    for (int i = 0; i < 3; i++) v[i] = all(f->second[i]);
    rotate(f->arm, other, v);
    for (int i = 0; i < 3; i++) {
        across[i] = s->position[3 * f->other + i] + f->arm[i] - s->position[3 * f->one + i] - f->onset[i];
        f->lever[i] = across[i] + f->onset[i];
    }
    rotate_back(wanted, f->frame, across);
    for (int i = 0; i < 3; i++) wanted[i] *= 1.0 / length;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            wanted_turn[3 * i + k] = f->frame[i] * end_frame[k] + f->frame[3 + i] * end_frame[3 + k] + f->frame[6 + i] * end_frame[6 + k];
    if (heavy) {
        rotate_back(f->weight, f->frame, s->gravity);
        for (int i = 0; i < 3; i++) f->weight[i] *= f->scalar[5];
    }
    if (!s->condensed) f->lack = condense(f, &s->scratch, wanted, wanted_turn, heavy);
    lanes wrench[6], force[3], moment[3], k[36], block[9], turned[9];
    for (int i = 0; i < 6; i++) wrench[i] = f->wrench[i] + f->answer[(k0 + i) * columns];
    rotate(force, f->frame, wrench), rotate(moment, f->frame, wrench + 3);
    for (int i = 0; i < 3; i++) force[i] *= unit / length, moment[i] *= unit;
    for (int p = 0; p < 2; p++)
        for (int o = 0; o < 2; o++) {
            const double scale = unit * (p ? 1.0 : 1.0 / length) * (o ? 1.0 : 1.0 / length);
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) block[3 * i + j] = scale * f->answer[(k0 + 3 * p + i) * columns + 1 + 3 * o + j];
            times(turned, f->frame, block), times_turned(block, turned, f->frame);
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) k[6 * (3 * p + i) + 3 * o + j] = block[3 * i + j];
        }
    if (j6 >= 0) add_moved(s, k, f->arm, f->arm, j6, j6, 1.0);
    if (i6 >= 0) add_moved(s, k, f->lever, f->lever, i6, i6, 1.0);
    if (i6 >= 0 && j6 >= 0) add_moved(s, k, f->lever, f->arm, i6, j6, -1.0), add_moved(s, k, f->arm, f->lever, j6, i6, -1.0);
    /* rotation of arms under the forces */
    lanes force_hat[9], moment_hat[9], product[9];
    hat(force_hat, force), hat(moment_hat, moment);
    if (i6 >= 0) {
        hat_times(product, f->lever, force_hat);
        add(s, i6, i6 + 3, force_hat, 1.0), add(s, i6 + 3, i6, force_hat, -1.0);
        add(s, i6 + 3, i6 + 3, product, 1.0), add(s, i6 + 3, i6 + 3, moment_hat, 1.0);
    }
    if (j6 >= 0) {
        times_hat(product, force_hat, f->arm);
        add(s, j6 + 3, j6 + 3, product, 1.0);
        if (i6 >= 0) {
            add(s, i6 + 3, j6, force_hat, 1.0), add(s, i6 + 3, j6 + 3, product, -1.0), add(s, j6, i6 + 3, force_hat, -1.0);
            hat_times(product, f->arm, force_hat);
            add(s, j6 + 3, i6 + 3, product, -1.0), add(s, j6 + 3, i6 + 3, moment_hat, -1.0);
        }
    }
    /* residual: the last column is its negative */
    lanes about[3];
    cross(about, f->lever, force);
    if (i6 >= 0)
        for (int i = 0; i < 3; i++) s->matrix[(i6 + i) * wide + s->n] += force[i], s->matrix[(i6 + 3 + i) * wide + s->n] += about[i] + moment[i];
    cross(about, f->arm, force);
    if (j6 >= 0)
        for (int i = 0; i < 3; i++) s->matrix[(j6 + i) * wide + s->n] -= force[i], s->matrix[(j6 + 3 + i) * wide + s->n] -= about[i] + moment[i];
    if (heavy && i6 >= 0) {
        lanes weight[3], hanging[3], sway[9], weight_hat[9], local_hat[9], row[9], m[9];
        rotate(weight, f->frame, f->weight), rotate(hanging, f->frame, f->middle);
        for (int i = 0; i < 3; i++) weight[i] *= unit / length, hanging[i] = f->onset[i] + length * hanging[i];
        cross(about, hanging, weight);
        for (int i = 0; i < 3; i++) s->matrix[(i6 + i) * wide + s->n] += weight[i], s->matrix[(i6 + 3 + i) * wide + s->n] += about[i];
        hat(weight_hat, weight), times_hat(product, weight_hat, hanging);
        add(s, i6 + 3, i6 + 3, product, -1.0);
        hat(local_hat, f->weight);
        times_turned(sway, local_hat, f->frame); /* weight in the start frame, by the rotation of the first body */
        for (int p = 0; p < 2; p++) { /* end forces by the weight, on all rows; motion of the weight by the end, on its row */
            const double scale = unit * (p ? 1.0 : 1.0 / length);
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) block[3 * i + j] = scale * f->answer[(k0 + 3 * p + i) * columns + 7 + j];
            times(row, block, sway), times(block, f->frame, row);
            if (i6 >= 0) {
                add(s, i6 + 3 * p, i6 + 3, block, -1.0);
                if (!p) hat_times(product, f->lever, block), add(s, i6 + 3, i6 + 3, product, -1.0);
            }
            if (j6 >= 0) {
                add(s, j6 + 3 * p, i6 + 3, block, 1.0);
                if (!p) hat_times(product, f->arm, block), add(s, j6 + 3, i6 + 3, product, 1.0);
            }
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) block[3 * i + j] = scale * f->mean[9 * i + 3 * p + j];
            times_turned(row, block, f->frame);
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) m[3 * i + j] = sway[i] * row[j] + sway[3 + i] * row[3 + j] + sway[6 + i] * row[6 + j]; /* sway^T row */
            add(s, i6 + 3, i6 + 3 * p, m, 1.0);
            if (!p) times_hat(product, m, f->lever), add(s, i6 + 3, i6 + 3, product, -1.0);
            if (j6 >= 0) {
                add(s, i6 + 3, j6 + 3 * p, m, -1.0);
                if (!p) times_hat(product, m, f->arm), add(s, i6 + 3, j6 + 3, product, 1.0);
            }
        }
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) block[3 * i + j] = unit * f->mean[9 * i + 6 + j];
        times(row, block, sway);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) m[3 * i + j] = sway[i] * row[j] + sway[3 + i] * row[3 + j] + sway[6 + i] * row[6 + j];
        add(s, i6 + 3, i6 + 3, m, -1.0);
    }
    return f->lack;
}

/* Other terms: constant-direction loads, other links and fixed coordinates. */
static lanes load(Stage *s)
{
    const Task *t = s->task;
    const int n = s->n, wide = n + 1;
    for (int i = 0; i < n * wide; i++) s->matrix[i] = all(0.0);
    lanes largest = all(0.0);
    if (t->residual)
        for (int lane = 0; lane < WIDTH; lane++) {
            const int64_t number = s->at[lane];
            for (int i = 0; i < n; i++) {
                const double value = t->residual[number * n + i];
                *one(s->matrix + i * wide + n, lane) = -value;
                if (i >= 6 * t->bodies && fabs(value) > largest[lane]) largest[lane] = fabs(value);
                for (int j = 0; j < n; j++) *one(s->matrix + i * wide + j, lane) = t->stiffness[(number * n + i) * n + j];
            }
        }
    for (int64_t d = 0; d < t->dead; d++) {
        const int64_t body = t->body[d], at = 6 * body;
        if (body >= t->bodies) continue;
        lanes drawn[3], arm[3], about[3], force_hat[9], block[9], *force = s->force + 6 * d;
        for (int i = 0; i < 3; i++) drawn[i] = all(t->arm[3 * d + i]);
        rotate(arm, s->turn + 9 * body, drawn), cross(about, arm, force);
        for (int i = 0; i < 3; i++) s->matrix[(at + i) * wide + n] += force[i], s->matrix[(at + 3 + i) * wide + n] += about[i] + force[3 + i];
        hat(force_hat, force), times_hat(block, force_hat, arm);
        add(s, at + 3, at + 3, block, -1.0);
    }
    return largest;
}

/* Step of the inner unknowns of a flexure for its body motions; returns the largest change of an amplitude. */
static lanes follow(Stage *s, Flexure *f, const lanes *moved, lanes share, lanes *poison)
{
    const int columns = f->columns, k0 = f->modes, e = (int)f->group->fields, x = (int)f->group->twist, heavy = (int)s->task->heavy;
    const int z = x + (int)f->group->across;
    const lanes *i = moved + 6 * f->one, *j = moved + 6 * f->other;
    lanes motion[9], place[3], spin[3], one_arm[3], other_arm[3], largest = all(0.0), fields[FIELDS];
    cross(one_arm, f->lever, i + 3), cross(other_arm, f->arm, j + 3);
    for (int c = 0; c < 3; c++) place[c] = j[c] - i[c] - other_arm[c] + one_arm[c], spin[c] = j[3 + c] - i[3 + c];
    rotate_back(motion, f->frame, place), rotate_back(motion + 3, f->frame, spin);
    for (int c = 0; c < 3; c++) motion[c] *= 1.0 / f->scalar[0];
    if (heavy) {
        lanes local[3];
        rotate_back(local, f->frame, i + 3), cross(motion + 6, f->weight, local);
    }
    for (int c = 0; c < e; c++) fields[c] = all(0.0);
    for (int r = 0; r < k0 + 6; r++) {
        const lanes *own = f->answer + r * columns;
        lanes t = own[0];
        for (int c = 0; c < columns - 1; c++) t += own[1 + c] * motion[c];
        t *= share;
        *poison += 0.0 * t;
        if (r < k0) {
            f->strain[r] += t, largest = larger(size_of(t), largest);
            if (e && (r < x || r >= z))
                for (int c = 0; c < e; c++) fields[c] += f->fields[r * e + c] * t;
        } else f->wrench[r - k0] += t;
    }
    for (int c = 0; c < e; c++) largest = larger(size_of(fields[c]), largest);
    return largest;
}

/* One iteration of all lanes: size of the step of bodies and amplitudes, and the previous residual of flexures. */
static __attribute__((noinline)) void iterate(Stage *s, lanes *size, lanes *lack)
{
    const Task *t = s->task;
    const int n = s->n, wide = n + 1, bodies = (int)t->bodies;
    *lack = load(s);
    for (int i = 0; i < s->flexures; i++) *lack = larger(bend(s, s->flexure + i), *lack);
    solve(s->matrix, n, 1);
    lanes largest = all(0.0), far = all(0.0), poison = all(0.0), inside = all(0.0);
    for (int i = 0; i < 6 * (bodies + 1); i++) s->step[i] = i < 6 * bodies ? s->matrix[i * wide + n] : all(0.0);
    for (int i = 0; i < 6 * bodies; i++) {
        const lanes value = size_of(s->step[i]);
        poison += 0.0 * value;
        largest = larger(value * (i % 6 < 3 ? 1.0 / t->size : 1.0), largest), far = larger(value * (i % 6 < 3 ? 1.0 / t->reach : 1.0), far);
    }
    const lanes share = t->limit / larger(far, all(t->limit));
    for (int i = 0; i < s->flexures; i++) inside = larger(follow(s, s->flexure + i, s->step, share, &poison), inside);
    for (int b = 0; b < bodies; b++) {
        lanes v[3], turn[9], after[9];
        for (int i = 0; i < 3; i++) s->position[3 * b + i] += share * s->step[6 * b + i], v[i] = share * s->step[6 * b + 3 + i];
        exponential(turn, v), times(after, turn, s->turn + 9 * b);
        memcpy(s->turn + 9 * b, after, sizeof after);
    }
    for (int i = 0; i < t->extra; i++) s->held[i] += share * s->matrix[(6 * bodies + i) * wide + n];
    *size = larger(inside, largest) + poison;
}

/* ---- memory ---- */

typedef struct {
    char *from;
    size_t used;
} Store;

static void *room(Store *store, size_t bytes)
{
    void *found = store->from ? store->from + store->used : NULL;
    store->used += (bytes + 63) / 64 * 64;
    return found;
}

/* Lay out a stage in memory; without memory it counts only. */
static void lay(Stage *s, Store *store, const Task *t)
{
    int modes = 0, points = 0, fields = 0, columns = t->heavy ? 10 : 7, count = 0;
    s->task = t, s->n = (int)(6 * t->bodies + t->extra), s->flexures = s->condensed = 0;
    for (int64_t g = 0; g < t->groups; g++) s->flexures += (int)t->group[g].links;
    s->flexure = room(store, (size_t)s->flexures * sizeof(Flexure) + 64);
    for (int64_t g = 0; g < t->groups; g++) {
        const Group *group = t->group + g;
        const int k = (int)(group->twist + group->across + group->bending), n = (int)group->points, e = (int)group->fields, q = k + e;
        if (k > modes) modes = k;
        if (n > points) points = n;
        if (e > fields) fields = e;
        for (int64_t i = 0; i < group->links; i++, count++) {
            double *paths = room(store, sizeof(double) * (size_t)(k * n * n)), *pairs = room(store, sizeof(double) * (size_t)(n * e * (e + 1) / 2));
            lanes *strain = room(store, sizeof(lanes) * (size_t)q), *curvature = room(store, sizeof(lanes) * (size_t)(3 * n));
            lanes *factor = room(store, sizeof(lanes) * (size_t)(e * e)), *follows = room(store, sizeof(lanes) * (size_t)(e * k));
            lanes *answer = room(store, sizeof(lanes) * (size_t)((k + 6) * columns));
            if (!store->from) continue;
            Flexure *f = s->flexure + count;
            f->group = group, f->number = (int)i, f->modes = k, f->amplitudes = q, f->columns = columns;
            f->phi = group->phi + i * k * n, f->inner = group->inner + i * k * 3 * (n + 1), f->form = group->form + i * q * q, f->rest = group->rest + i * q;
            f->plate = group->plate + i * n * 2 * e, f->compliance = group->compliance + i * n * 3, f->scalar = group->scalar + i * 7;
            f->turn = group->turn + 9 * i, f->first = group->first + 3 * i, f->second = group->second + 3 * i;
            f->one = group->joins[2 * i], f->other = group->joins[2 * i + 1];
            f->paths = paths, f->pairs = pairs, f->strain = strain, f->curvature = curvature, f->factor = factor, f->fields = follows;
            f->answer = answer;
            for (int m = 0; m < k; m++)
                for (int a = 0; a < n; a++)
                    for (int b = 0; b < n; b++) paths[(m * n + a) * n + b] = group->running[a * n + b] * f->phi[m * n + b];
            for (int p = 0; p < n; p++)
                for (int a = 0, at = 0; a < e; a++)
                    for (int b = 0; b <= a; b++, at++) {
                        const double *two = f->plate + 2 * p * e, *four = two + e;
                        pairs[p * e * (e + 1) / 2 + at] = group->weights[p] * (f->scalar[3] * two[a] * two[b] + f->scalar[4] * four[a] * four[b]);
                    }
        }
    }
    const size_t path = sizeof(lanes) * (size_t)(3 * points * modes), n = (size_t)s->n, bodies = (size_t)t->bodies + 1;
    s->scratch.turned = room(store, path), s->scratch.carried = room(store, path), s->scratch.work = room(store, path);
    s->scratch.matrix = room(store, sizeof(lanes) * (size_t)((modes + 6) * (modes + 6 + columns)));
    s->scratch.steep = room(store, sizeof(lanes) * (size_t)(modes * fields));
    s->position = room(store, sizeof(lanes) * 3 * bodies), s->turn = room(store, sizeof(lanes) * 9 * bodies);
    s->held = room(store, sizeof(lanes) * (size_t)t->extra), s->gravity = room(store, sizeof(lanes) * 3);
    s->force = room(store, sizeof(lanes) * 6 * (size_t)t->dead), s->matrix = room(store, sizeof(lanes) * n * (n + 1));
    s->step = room(store, sizeof(lanes) * 6 * bodies);
}

static int fits(const Task *t)
{
    for (int64_t g = 0; g < t->groups; g++) {
        const Group *group = t->group + g;
        if (group->points > POINTS || group->twist + group->across + group->bending > MODES || group->fields > FIELDS) return 0;
    }
    return t->cases > 0;
}

/* ---- the cases ---- */

enum { CONVERGED, NOT_CONVERGED, SINGULAR, OPEN };

/* Whether all cases have the start pose of the first: then they share the flexure tables of the first step. */
static int begin_alike(const Task *t)
{
    const int64_t n = t->bodies + 1;
    for (int64_t i = 1; i < t->cases; i++) {
        if (memcmp(t->position, t->position + 3 * n * i, (size_t)(3 * n) * sizeof(double))) return 0;
        if (memcmp(t->turn, t->turn + 9 * n * i, (size_t)(9 * n) * sizeof(double))) return 0;
        if (memcmp(t->gravity, t->gravity + 3 * i, 3 * sizeof(double))) return 0;
    }
    for (int64_t g = 0; g < t->groups; g++) {
        const Group *group = t->group + g;
        const int64_t q = group->twist + group->across + group->bending + group->fields;
        for (int64_t i = 0; i < group->links * t->cases; i++) {
            const int64_t first = i - i % t->cases;
            if (memcmp(group->strain + q * first, group->strain + q * i, (size_t)q * sizeof(double))) return 0;
            if (memcmp(group->wrench + 6 * first, group->wrench + 6 * i, 6 * sizeof(double))) return 0;
        }
    }
    return 1;
}

/* One iteration of the lanes with a case, and their status after it. */
static void advance(Stage *s)
{
    const Task *t = s->task;
    lanes size, lack;
    int some = 0;
    iterate(s, &size, &lack);
    for (int lane = 0; lane < WIDTH; lane++) {
        const int64_t number = s->cases[lane];
        if (number < 0) continue;
        t->count[number] = ++s->done[lane], t->moved[number] = size[lane], t->lack[number] = lack[lane];
        if (!isfinite(size[lane])) t->status[number] = SINGULAR;
        else if (size[lane] < t->step && lack[lane] < t->gap) t->status[number] = CONVERGED;
        else if (s->done[lane] >= t->iterations) t->status[number] = NOT_CONVERGED;
        some |= t->status[number] != OPEN;
    }
    if (!some) return;
    for (int i = 0; i < s->flexures; i++) settle(s->flexure + i);
}

/* The next open case, or -1. */
static int64_t draw(Stage *s)
{
    while (s->next < s->task->cases && s->task->status[s->next] != OPEN) s->next++;
    return s->next < s->task->cases ? s->next++ : -1;
}

/* Fill all lanes; lanes without a case repeat the last one, without output. Returns the number of lanes with a case. */
static int fill(Stage *s)
{
    int busy = 0;
    for (int lane = 0; lane < WIDTH; lane++) {
        const int64_t number = draw(s);
        take(s, lane, number < 0 ? s->task->cases - 1 : number);
        if (number < 0) s->cases[lane] = -1;
        else busy++;
    }
    return busy;
}

int64_t flexstage_equilibria(const Task *task);
int64_t flexstage_equilibria_width(void);

int64_t flexstage_equilibria_width(void) { return WIDTH; }

/* All cases of a task, in place; returns 1 without memory, or for tables that are too large. */
int64_t flexstage_equilibria(const Task *task)
{
    Stage stage;
    Store store = {NULL, 0};
    if (!fits(task)) return 1;
    lay(&stage, &store, task);
    char *memory = calloc(store.used + 64, 1);
    if (!memory) return 1;
    store.from = memory + (64 - (uintptr_t)memory % 64), store.used = 0;
    lay(&stage, &store, task);
    for (int64_t i = 0; i < task->cases; i++) task->status[i] = OPEN, task->count[i] = 0;
    if (task->cases > WIDTH && begin_alike(task))
        for (stage.next = 0; fill(&stage); stage.condensed = 1) {
            advance(&stage);
            for (int lane = 0; lane < WIDTH; lane++)
                if (stage.cases[lane] >= 0) put(&stage, lane);
        }
    stage.next = stage.condensed = 0;
    int busy = fill(&stage);
    while (busy) {
        advance(&stage);
        for (int lane = 0; lane < WIDTH; lane++) {
            if (stage.cases[lane] < 0 || task->status[stage.cases[lane]] == OPEN) continue;
            put(&stage, lane);
            const int64_t number = draw(&stage);
            if (number >= 0) take(&stage, lane, number);
            else stage.cases[lane] = -1, busy--;
        }
    }
    free(memory);
    return 0;
}
