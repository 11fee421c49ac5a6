/* Small dense linear algebra in a fixed order of operations: the same bits from every compiler and processor. */
#include "vector_units.h"
#include <math.h>
#include <string.h>

enum { SWEEPS = 60, SHIFTS = 60 };
#define ROUNDING 0x1p-52

/* --- products ------------------------------------------------------------------------------------ */

/* Four sums side by side, which fill a vector unit. */
static double dot(int64_t n, const double *a, const double *b)
{
    double s[4] = {0.0, 0.0, 0.0, 0.0};
    int64_t i = 0;
    for (; i + 4 <= n; i += 4)
        for (int j = 0; j < 4; j++) s[j] += a[i + j] * b[i + j];
    for (; i < n; i++) s[0] += a[i] * b[i];
    return (s[0] + s[1]) + (s[2] + s[3]);
}

static void add_multiple(int64_t n, double factor, const double *restrict a, double *restrict b)
{
    for (int64_t i = 0; i < n; i++) b[i] += factor * a[i];
}

enum { MOST = 32, NARROW = 4, DEEP = 64 };
typedef double four_t __attribute__((vector_size(32), aligned(8), may_alias));

/* A matrix with any steps between its rows and columns. */
typedef struct { const double *values; int64_t row, column; } matrix_t;

/* Columns j to j + n of a product (m, k)(k, n), n ≤ wide: as many sums side by side. */
IN_BOTH void panel(const int wide, int64_t m, int64_t n, int64_t k, matrix_t a, matrix_t b, double *c, int64_t c_row,
                   int64_t c_column)
{
    four_t packed[DEEP * MOST / 4];
    double *pack = (double *)packed;
    for (int64_t first = 0; first == 0 || first < k; first += DEEP) {
        int64_t deep = k - first < DEEP ? k - first : DEEP;
        for (int64_t p = 0; p < deep; p++)
            for (int w = 0; w < wide; w++)
                pack[wide * p + w] = w < n ? b.values[(first + p) * b.row + w * b.column] : 0.0;
        for (int64_t i = 0; i < m; i++) {
            const double *left = a.values + i * a.row + first * a.column;
            four_t s[MOST / 4] = {{0.0}};
            double *sum = (double *)s;
            if (first) for (int64_t w = 0; w < n; w++) sum[w] = c[i * c_row + w * c_column];
            for (int64_t p = 0; p < deep; p++) {
                double one = left[p * a.column];
                four_t factor = {one, one, one, one};
                for (int w = 0; w < wide / 4; w++) s[w] += factor * packed[wide / 4 * p + w];
            }
            for (int64_t w = 0; w < n; w++) c[i * c_row + w * c_column] = sum[w];
        }
    }
}

/* c = a b, each entry summed in the order of its index. */
IN_BOTH void panels(const int most, int64_t m, int64_t n, int64_t k, matrix_t a, matrix_t b, double *c, int64_t c_row,
                    int64_t c_column)
{
    while (n > 0) {
        int64_t wide = n > NARROW ? most : NARROW, now = n < wide ? n : wide;
        if (wide == most) panel(most, m, now, k, a, b, c, c_row, c_column);
        else panel(NARROW, m, now, k, a, b, c, c_row, c_column);
        b.values += now * b.column;
        c += now * c_column;
        n -= now;
    }
}

/* The longer side of the result is that of the sums side by side; the bits are the same. */
IN_BOTH void any_product(const int most, int64_t m, int64_t n, int64_t k, const double *a, const double *b, double *c)
{
    if (n >= m) panels(most, m, n, k, (matrix_t){a, k, 1}, (matrix_t){b, n, 1}, c, n, 1);
    else panels(most, n, m, k, (matrix_t){b, 1, n}, (matrix_t){a, 1, k}, c, 1, n);
}

static void plain_product(int64_t m, int64_t n, int64_t k, const double *a, const double *b, double *c)
{
    any_product(16, m, n, k, a, b, c);
}

static WIDER void wide_product(int64_t m, int64_t n, int64_t k, const double *a, const double *b, double *c)
{
    any_product(32, m, n, k, a, b, c);
}

void product(int64_t m, int64_t n, int64_t k, const double *a, const double *b, double *c)
{
    if (has_wider()) wide_product(m, n, k, a, b, c);
    else plain_product(m, n, k, a, b, c);
}

/* --- singular values ----------------------------------------------------------------------------- */

/* Householder QR with the largest column first. Columns (n, m) become reflectors, `order` says which came when;
 * room: what each reflector divides by. R stands in `upper` (n, n). */
static void factorise(int64_t m, int64_t n, double *columns, int64_t *order, double *upper, double *divisor)
{
    memset(upper, 0, (size_t)(n * n) * sizeof *upper);
    for (int64_t j = 0; j < n; j++) order[j] = j;
    for (int64_t i = 0; i < n; i++) {
        double most = -1.0, *x = columns + i * m, size;
        int64_t pick = i;
        for (int64_t j = i; j < n; j++) {
            double square = dot(m - i, columns + j * m + i, columns + j * m + i);
            if (square > most) { most = square; pick = j; }
        }
        if (pick != i) {
            int64_t was = order[i];
            order[i] = order[pick];
            order[pick] = was;
            for (int64_t r = 0; r < m; r++) {
                double kept = x[r];
                x[r] = columns[pick * m + r];
                columns[pick * m + r] = kept;
            }
            for (int64_t r = 0; r < i; r++) {
                double kept = upper[r * n + i];
                upper[r * n + i] = upper[r * n + pick];
                upper[r * n + pick] = kept;
            }
        }
        size = x[i] > 0.0 ? -sqrt(most) : sqrt(most);
        upper[i * n + i] = size;
        x[i] -= size;
        divisor[i] = -size * x[i]; /* half the square of the reflector */
        if (divisor[i] == 0.0) continue;
        for (int64_t j = i + 1; j < n; j++) {
            double *y = columns + j * m;
            add_multiple(m - i, -dot(m - i, x + i, y + i) / divisor[i], x + i, y + i);
            upper[i * n + j] = y[i];
        }
    }
}

/* One rotation of two rows; the square of the first and of the second afterwards. */
static void rotate(int64_t n, double cosine, double sine, double *restrict x, double *restrict y)
{
    for (int64_t i = 0; i < n; i++) {
        double a = x[i], b = y[i];
        x[i] = cosine * a - sine * b;
        y[i] = sine * a + cosine * b;
    }
}

/* Rows of x (n, n) become orthogonal; rows of v are rotated alike. 0: they do not in SWEEPS sweeps. */
static int64_t orthogonalise(int64_t n, double *x, double *v, double *square)
{
    double small = ROUNDING * sqrt((double)n);
    for (int64_t sweep = 0; sweep < SWEEPS; sweep++) {
        int64_t turned = 0;
        for (int64_t i = 0; i < n; i++) square[i] = dot(n, x + i * n, x + i * n);
        for (int64_t p = 0; p < n; p++) {
            for (int64_t q = p + 1; q < n; q++) {
                double *a = x + p * n, *b = x + q * n, c = dot(n, a, b), z, t, cosine;
                if (!(fabs(c) > small * sqrt(square[p]) * sqrt(square[q]))) continue;
                z = (square[q] - square[p]) / (2.0 * c);
                t = (z < 0.0 ? -1.0 : 1.0) / (fabs(z) + (fabs(z) < 1e150 ? sqrt(1.0 + z * z) : fabs(z)));
                cosine = 1.0 / sqrt(1.0 + t * t);
                rotate(n, cosine, cosine * t, a, b);
                rotate(n, cosine, cosine * t, v + p * n, v + q * n);
                square[p] = dot(n, a, a);
                square[q] = dot(n, b, b);
                turned = 1;
            }
        }
        if (!turned) return 1;
    }
    return 0;
}

int64_t jacobi_svd(int64_t m, int64_t n, double *columns, double *left, double *sigma, double *right,
                   int64_t *order, double *room)
{
    double *x = room, *v = room + n * n, *divisor = room + 2 * n * n, *square = divisor + n;
    factorise(m, n, columns, order, x, divisor);
    memset(v, 0, (size_t)(n * n) * sizeof *v);
    for (int64_t i = 0; i < n; i++) v[i * n + i] = 1.0;
    if (!orthogonalise(n, x, v, square)) return 0;
    for (int64_t i = 0; i < n; i++) {
        double *u = left + i * m;
        sigma[i] = sqrt(square[i]);
        for (int64_t j = 0; j < n; j++)
            right[i * n + order[j]] = sigma[i] > 0.0 ? x[i * n + j] / sigma[i] : 0.0;
        memset(u, 0, (size_t)m * sizeof *u);
        memcpy(u, v + i * n, (size_t)n * sizeof *u);
        for (int64_t j = n - 1; j >= 0; j--) {
            const double *reflector = columns + j * m + j;
            if (divisor[j] != 0.0)
                add_multiple(m - j, -dot(m - j, reflector, u + j) / divisor[j], reflector, u + j);
        }
    }
    return 1;
}

/* --- linear equations ----------------------------------------------------------------------------- */

/* a (n, n) becomes its factors, b (n, r) the solution; rows with the largest pivot first. 0: singular. */
int64_t solve_real(int64_t n, int64_t r, double *a, double *b)
{
    for (int64_t k = 0; k < n; k++) {
        int64_t pick = k;
        for (int64_t i = k + 1; i < n; i++)
            if (fabs(a[i * n + k]) > fabs(a[pick * n + k])) pick = i;
        if (!(fabs(a[pick * n + k]) > 0.0)) return 0;
        for (int64_t j = 0; j < n && pick != k; j++) {
            double kept = a[k * n + j];
            a[k * n + j] = a[pick * n + j];
            a[pick * n + j] = kept;
        }
        for (int64_t j = 0; j < r && pick != k; j++) {
            double kept = b[k * r + j];
            b[k * r + j] = b[pick * r + j];
            b[pick * r + j] = kept;
        }
        for (int64_t i = k + 1; i < n; i++) {
            double factor = a[i * n + k] / a[k * n + k];
            if (factor == 0.0) continue;
            add_multiple(n - k - 1, -factor, a + k * n + k + 1, a + i * n + k + 1);
            add_multiple(r, -factor, b + k * r, b + i * r);
        }
    }
    for (int64_t k = n - 1; k >= 0; k--) {
        for (int64_t j = k + 1; j < n; j++) add_multiple(r, -a[k * n + j], b + j * r, b + k * r);
        for (int64_t j = 0; j < r; j++) b[k * r + j] /= a[k * n + k];
    }
    return 1;
}

typedef struct { double real, imaginary; } complex_t;

static inline complex_t times(complex_t a, complex_t b)
{
    return (complex_t){a.real * b.real - a.imaginary * b.imaginary, a.real * b.imaginary + a.imaginary * b.real};
}

static inline complex_t over(complex_t a, complex_t b)
{
    double size = fabs(b.real) > fabs(b.imaginary) ? fabs(b.real) : fabs(b.imaginary), square;
    b.real /= size;
    b.imaginary /= size;
    square = b.real * b.real + b.imaginary * b.imaginary;
    a = times(a, (complex_t){b.real, -b.imaginary});
    return (complex_t){a.real / square / size, a.imaginary / square / size};
}

/* Row b −= factor × row a; real and imaginary parts apart. */
static void subtract_multiple(int64_t n, complex_t factor, const double *restrict a, const double *restrict a_i,
                              double *restrict b, double *restrict b_i)
{
    for (int64_t i = 0; i < n; i++) {
        b[i] -= factor.real * a[i] - factor.imaginary * a_i[i];
        b_i[i] -= factor.real * a_i[i] + factor.imaginary * a[i];
    }
}

static void exchange(int64_t n, double *restrict a, double *restrict b)
{
    for (int64_t i = 0; i < n; i++) {
        double kept = a[i];
        a[i] = b[i];
        b[i] = kept;
    }
}

/* Factors in place of the parts of a (n, n), rows in the order `rows`; 0: singular. */
static int64_t factors(int64_t n, double *a, double *a_i, int64_t *rows)
{
    for (int64_t k = 0; k < n; k++) {
        int64_t pick = k;
        double most = -1.0;
        for (int64_t i = k; i < n; i++) {
            double size = fabs(a[i * n + k]) + fabs(a_i[i * n + k]);
            if (size > most) { most = size; pick = i; }
        }
        if (!(most > 0.0)) return 0;
        rows[k] = pick;
        if (pick != k) {
            exchange(n, a + k * n, a + pick * n);
            exchange(n, a_i + k * n, a_i + pick * n);
        }
        for (int64_t i = k + 1; i < n; i++) {
            complex_t factor = {a[i * n + k], a_i[i * n + k]};
            if (factor.real == 0.0 && factor.imaginary == 0.0) continue;
            factor = over(factor, (complex_t){a[k * n + k], a_i[k * n + k]});
            subtract_multiple(n - k - 1, factor, a + k * n + k + 1, a_i + k * n + k + 1, a + i * n + k + 1,
                              a_i + i * n + k + 1);
            a[i * n + k] = factor.real;
            a_i[i * n + k] = factor.imaginary;
        }
    }
    return 1;
}

/* Solution in place of the parts of b (n, r). */
static void substitute(int64_t n, int64_t r, const double *a, const double *a_i, const int64_t *rows, double *b,
                       double *b_i)
{
    for (int64_t k = 0; k < n; k++) {
        if (rows[k] != k) {
            exchange(r, b + k * r, b + rows[k] * r);
            exchange(r, b_i + k * r, b_i + rows[k] * r);
        }
    }
    for (int64_t i = 0; i < n; i++)
        for (int64_t k = 0; k < i; k++)
            subtract_multiple(r, (complex_t){a[i * n + k], a_i[i * n + k]}, b + k * r, b_i + k * r, b + i * r,
                              b_i + i * r);
    for (int64_t i = n - 1; i >= 0; i--) {
        for (int64_t k = i + 1; k < n; k++)
            subtract_multiple(r, (complex_t){a[i * n + k], a_i[i * n + k]}, b + k * r, b_i + k * r, b + i * r,
                              b_i + i * r);
        for (int64_t j = 0; j < r; j++) {
            complex_t x = over((complex_t){b[i * r + j], b_i[i * r + j]},
                               (complex_t){a[i * n + i], a_i[i * n + i]});
            b[i * r + j] = x.real;
            b_i[i * r + j] = x.imaginary;
        }
    }
}

/* Factors of systems one after the other: a (count, n, n) of real and imaginary parts in turn, f (count, 2, n, n) of all
 * the real ones and then the imaginary ones, rows (count, n). 0: one is singular. */
int64_t factor_complex(int64_t count, int64_t n, const double *a, double *f, int64_t *rows)
{
    for (int64_t s = 0; s < count; s++, a += 2 * n * n, f += 2 * n * n, rows += n) {
        for (int64_t i = 0; i < n * n; i++) { f[i] = a[2 * i]; f[n * n + i] = a[2 * i + 1]; }
        if (!factors(n, f, f + n * n, rows)) return 0;
    }
    return 1;
}

/* Solutions in place of b (count, n, r), of real and imaginary parts in turn, for the systems a and their factors; each
 * is corrected once by its residual. Room: 4 n r. */
void solve_complex(int64_t count, int64_t n, int64_t r, const double *a, const double *f, const int64_t *rows,
                   double *b, double *room)
{
    double *x = room, *x_i = x + n * r, *d = x_i + n * r, *d_i = d + n * r;
    for (int64_t s = 0; s < count; s++, a += 2 * n * n, f += 2 * n * n, rows += n, b += 2 * n * r) {
        for (int64_t i = 0; i < n * r; i++) { d[i] = x[i] = b[2 * i]; d_i[i] = x_i[i] = b[2 * i + 1]; }
        substitute(n, r, f, f + n * n, rows, x, x_i);
        for (int64_t i = 0; i < n; i++)
            for (int64_t k = 0; k < n; k++) {
                complex_t entry = {a[2 * (i * n + k)], a[2 * (i * n + k) + 1]};
                if (entry.real != 0.0 || entry.imaginary != 0.0)
                    subtract_multiple(r, entry, x + k * r, x_i + k * r, d + i * r, d_i + i * r);
            }
        substitute(n, r, f, f + n * n, rows, d, d_i);
        for (int64_t i = 0; i < n * r; i++) { b[2 * i] = x[i] + d[i]; b[2 * i + 1] = x_i[i] + d_i[i]; }
    }
}

/* --- eigenvalues ---------------------------------------------------------------------------------- */

/* Hessenberg form of a (n, n) by elimination, the largest pivot first. */
static void hessenberg(int64_t n, double *a)
{
    for (int64_t m = 1; m < n - 1; m++) {
        int64_t pick = m;
        for (int64_t i = m + 1; i < n; i++)
            if (fabs(a[i * n + m - 1]) > fabs(a[pick * n + m - 1])) pick = i;
        if (a[pick * n + m - 1] == 0.0) continue;
        if (pick != m) {
            exchange(n, a + pick * n, a + m * n);
            for (int64_t i = 0; i < n; i++) {
                double kept = a[i * n + pick];
                a[i * n + pick] = a[i * n + m];
                a[i * n + m] = kept;
            }
        }
        for (int64_t i = m + 1; i < n; i++) {
            double factor = a[i * n + m - 1] / a[m * n + m - 1];
            if (factor == 0.0) continue;
            add_multiple(n, -factor, a + m * n, a + i * n);
            a[i * n + m - 1] = 0.0;
            for (int64_t j = 0; j < n; j++) a[j * n + m] += factor * a[j * n + i];
        }
    }
}

/* Eigenvalues of the two rows that end with `last`. */
static void last_pair(int64_t n, const double *a, int64_t last, double shifted, double *real, double *imaginary)
{
    double x = a[last * n + last], y = a[(last - 1) * n + last - 1];
    double w = a[last * n + last - 1] * a[(last - 1) * n + last];
    double p = 0.5 * (y - x), q = p * p + w, z = sqrt(fabs(q));
    x += shifted;
    if (q >= 0.0) {
        z = p + (p < 0.0 ? -z : z);
        real[last - 1] = x + z;
        real[last] = z != 0.0 ? x - w / z : x + z;
        imaginary[last - 1] = imaginary[last] = 0.0;
    } else {
        real[last - 1] = real[last] = x + p;
        imaginary[last - 1] = z;
        imaginary[last] = -z;
    }
}

/* One double step of Francis on rows `first` to `last`, with the shifts x, y and x y − w. */
static void francis(int64_t n, double *a, int64_t first, int64_t last, double x, double y, double w)
{
    double p = 0.0, q = 0.0, r = 0.0, s;
    int64_t m = last - 2;
    for (;; m--) {
        double z = a[m * n + m], u, v;
        double to_x = x - z, to_y = y - z;
        p = (to_x * to_y - w) / a[(m + 1) * n + m] + a[m * n + m + 1];
        q = a[(m + 1) * n + m + 1] - z - to_x - to_y;
        r = a[(m + 2) * n + m + 1];
        s = fabs(p) + fabs(q) + fabs(r);
        p /= s;
        q /= s;
        r /= s;
        if (m == first) break;
        u = fabs(a[m * n + m - 1]) * (fabs(q) + fabs(r));
        v = fabs(p) * (fabs(a[(m - 1) * n + m - 1]) + fabs(z) + fabs(a[(m + 1) * n + m + 1]));
        if (u <= ROUNDING * v) break;
    }
    for (int64_t i = m + 2; i <= last; i++) {
        a[i * n + i - 2] = 0.0;
        if (i > m + 2) a[i * n + i - 3] = 0.0;
    }
    for (int64_t k = m; k < last; k++) {
        int three = k < last - 1;
        int64_t deepest = last < k + 3 ? last : k + 3;
        double size = 1.0;
        if (k > m) {
            p = a[k * n + k - 1];
            q = a[(k + 1) * n + k - 1];
            r = three ? a[(k + 2) * n + k - 1] : 0.0;
            size = fabs(p) + fabs(q) + fabs(r);
            if (size == 0.0) continue;
            p /= size;
            q /= size;
            r /= size;
        }
        s = sqrt(p * p + q * q + r * r);
        if (p < 0.0) s = -s;
        if (s == 0.0) continue;
        if (k > m) a[k * n + k - 1] = -s * size;
        else if (first != m) a[k * n + k - 1] = -a[k * n + k - 1];
        p += s;
        x = p / s;
        y = q / s;
        w = r / s;
        q /= p;
        r /= p;
        for (int64_t j = k; j <= last; j++) {
            double t = a[k * n + j] + q * a[(k + 1) * n + j];
            if (three) {
                t += r * a[(k + 2) * n + j];
                a[(k + 2) * n + j] -= t * w;
            }
            a[(k + 1) * n + j] -= t * y;
            a[k * n + j] -= t * x;
        }
        for (int64_t i = first; i <= deepest; i++) {
            double t = x * a[i * n + k] + y * a[i * n + k + 1];
            if (three) {
                t += w * a[i * n + k + 2];
                a[i * n + k + 2] -= t * r;
            }
            a[i * n + k + 1] -= t * q;
            a[i * n + k] -= t;
        }
    }
}

/* Eigenvalues of a (n, n), which is overwritten: Hessenberg form, then steps of Francis with two shifts (after the
 * public-domain routines of EISPACK). 0: no convergence. */
int64_t eigenvalues(int64_t n, double *a, double *real, double *imaginary)
{
    double norm = 0.0, shifted = 0.0;
    int64_t last = n - 1, tried = 0;
    hessenberg(n, a);
    for (int64_t i = 0; i < n * n; i++) norm += fabs(a[i]);
    while (last >= 0) {
        int64_t first = last;
        double x = a[last * n + last], y, w;
        for (; first > 0; first--) {
            double size = fabs(a[(first - 1) * n + first - 1]) + fabs(a[first * n + first]);
            if (fabs(a[first * n + first - 1]) <= ROUNDING * (size == 0.0 ? norm : size)) {
                a[first * n + first - 1] = 0.0;
                break;
            }
        }
        if (first == last) {
            real[last] = x + shifted;
            imaginary[last--] = 0.0;
            tried = 0;
            continue;
        }
        if (first == last - 1) {
            last_pair(n, a, last, shifted, real, imaginary);
            last -= 2;
            tried = 0;
            continue;
        }
        if (++tried > SHIFTS) return 0;
        y = a[(last - 1) * n + last - 1];
        w = a[last * n + last - 1] * a[(last - 1) * n + last];
        if (tried % 10 == 0) { /* an unusual shift */
            double s = fabs(a[last * n + last - 1]) + fabs(a[(last - 1) * n + last - 2]);
            shifted += x;
            for (int64_t i = 0; i <= last; i++) a[i * n + i] -= x;
            x = y = 0.75 * s;
            w = -0.4375 * s * s;
        }
        francis(n, a, first, last, x, y, w);
    }
    return 1;
}
