/* Work with 6x6 blocks that fall into blocks of SIZE on their diagonal, which have nothing in common: included for each SIZE, so that all loops are of
 * known length and what they work on stays in registers. */

/* n columns of y (6, m) += a x or -= a x: each entry of a is used n times. */
static INLINE void SIZED(multiply)(lanes *restrict y, const lanes *restrict a, const lanes *x, int m, const int kind, const int negative, const int n)
{
    UNROLL for (int h = 0; h < 6; h += SIZE)
        UNROLL for (int r = h; r < h + SIZE; r++) {
            lanes s[4];
            UNROLL for (int k = 0; k < n; k++) s[k] = y[r * m + k];
            UNROLL for (int c = h; c < h + SIZE; c++) {
                const lanes e = entry(a, r, c, kind);
                UNROLL for (int k = 0; k < n; k++) s[k] = negative ? s[k] - e * x[c * n + k] : s[k] + e * x[c * n + k];
            }
            UNROLL for (int k = 0; k < n; k++) y[r * m + k] = s[k];
        }
}

/* An own block of K - shift M. */
static INLINE void SIZED(shifted)(lanes *to, const lanes *stiff, const lanes *mass, lanes shift)
{
    UNROLL for (int i = 0; i < 6; i++)
        UNROLL for (int k = i / SIZE * SIZE; k <= i; k++) to[LOWER(i, k)] = stiff[LOWER(i, k)] - shift * mass[LOWER(i, k)];
}

/* own = L D L^T: L below the diagonal, D^-1 on it. */
static INLINE void SIZED(invert)(lanes *own, lanes *pivot)
{
    UNROLL for (int h = 0; h < 6; h += SIZE) {
        lanes a[OWN];
        UNROLL for (int i = 0; i < SIZE; i++)
            UNROLL for (int k = 0; k <= i; k++) a[LOWER(i, k)] = own[LOWER(h + i, h + k)];
        UNROLL for (int s = 0; s < SIZE; s++) {
            const lanes inverse = 1.0 / (pivot[h + s] = a[LOWER(s, s)]);
            UNROLL for (int i = s + 1; i < SIZE; i++) {
                const lanes l = a[LOWER(i, s)] * inverse;
                for (int k = s + 1; k <= i; k++) a[LOWER(i, k)] -= l * a[LOWER(k, s)];
            }
            UNROLL for (int i = s + 1; i < SIZE; i++) a[LOWER(i, s)] *= inverse;
            a[LOWER(s, s)] = inverse;
        }
        UNROLL for (int i = 0; i < SIZE; i++)
            UNROLL for (int k = 0; k <= i; k++) own[LOWER(h + i, h + k)] = a[LOWER(i, k)];
    }
}

/* Edges of K - shift M: L^-1 times themselves, of an own block; all columns, or those of each block on the diagonal (`narrow`). */
static INLINE void SIZED(reduce)(lanes *edge, const lanes *stiff, const lanes *mass, lanes shift, const lanes *own, const int fills, const int narrow)
{
    UNROLL for (int h = 0; h < 6; h += SIZE)
        UNROLL for (int half = 0; half < 6; half += 3) {
            if (narrow && half / SIZE != h / SIZE) continue;
            const int first = 6 * h + half;
            lanes x[3 * SIZE];
            UNROLL for (int i = 0; i < 3 * SIZE; i++) {
                const int at = first + 6 * (i / 3) + i % 3;
                x[i] = fills ? edge[at] : stiff[at] - shift * mass[at];
            }
            UNROLL for (int s = 0; s < SIZE; s++)
                UNROLL for (int i = s + 1; i < SIZE; i++)
                    UNROLL for (int c = 0; c < 3; c++) x[3 * i + c] -= own[LOWER(h + i, h + s)] * x[3 * s + c];
            UNROLL for (int i = 0; i < 3 * SIZE; i++) edge[first + 6 * (i / 3) + i % 3] = x[i];
        }
}

/* Three rows of an own block from `first` on -= x^T D x, x of blocks of SIZE. */
static INLINE void SIZED(update)(lanes *restrict to, const lanes *restrict x, const lanes *restrict a, const int first)
{
    lanes sum[OWN];
    UNROLL for (int i = first; i < first + 3; i++)
        UNROLL for (int k = first / SIZE * SIZE; k <= i; k++) sum[LOWER(i, k)] = to[LOWER(i, k)];
    UNROLL for (int r = 0; r < SIZE; r++)
        UNROLL for (int i = first; i < first + 3; i++) {
            const int row = first / SIZE * SIZE + r;
            const lanes scaled = x[6 * row + i] * a[LOWER(row, row)];
            for (int k = first / SIZE * SIZE; k <= i; k++) sum[LOWER(i, k)] -= scaled * x[6 * row + k];
        }
    UNROLL for (int i = first; i < first + 3; i++)
        UNROLL for (int k = first / SIZE * SIZE; k <= i; k++) to[LOWER(i, k)] = sum[LOWER(i, k)];
}

/* n columns u (6, n): L^-1 u. */
static INLINE void SIZED(lower)(lanes *u, const lanes *a, const int n)
{
    UNROLL for (int h = 0; h < 6; h += SIZE)
        UNROLL for (int s = 0; s < SIZE; s++)
            UNROLL for (int i = s + 1; i < SIZE; i++)
                UNROLL for (int k = 0; k < n; k++) u[(h + i) * n + k] -= a[LOWER(h + i, h + s)] * u[(h + s) * n + k];
}

/* L^-T u. */
static INLINE void SIZED(upper)(lanes *u, const lanes *a, const int n)
{
    UNROLL for (int h = 0; h < 6; h += SIZE)
        UNROLL for (int i = SIZE - 1; i > 0; i--)
            UNROLL for (int s = 0; s < i; s++)
                UNROLL for (int k = 0; k < n; k++) u[(h + s) * n + k] -= a[LOWER(h + i, h + s)] * u[(h + i) * n + k];
}
