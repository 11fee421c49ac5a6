/* Eigenvectors of a tridiagonal matrix without diagonal, several side by side: the singular vectors of a chain. */
#include "kernels.h"
#include <math.h>

enum { BESIDE = 8 }; /* a line of the cache */
#define ROUNDING 0x1p-52

static inline double not_zero(double pivot, double sigma)
{
    return pivot == 0.0 ? -ROUNDING * ROUNDING * sigma : pivot; /* far below a rounding of σ, far from overflow */
}

/* Corrections of positive eigenvalues sigma (count) of the tridiagonal of n rows with b (n - 1) beside its diagonal.
 *
 * Elimination from both ends meets where the pivot is least: there the vector is large, and both ways out from there
 * it is a product of ratios, without cancellation. Entries in turn are those of `right` and of `left`, each of them of
 * unit length: entry i stands in row place[i] of its matrix, whose rows lie `row` numbers apart. Without matrices only
 * the corrections are found. room: 2 n 8. */
void chain_vectors(int64_t n, const double *b, int64_t count, const double *sigma, double *correction,
                   const int64_t *place, int64_t row, double *right, double *left, double *room)
{
    double (*ahead)[BESIDE] = (double (*)[BESIDE])room, (*behind)[BESIDE] = ahead + n;
    for (int64_t first = 0; first < count; first += BESIDE) {
        int64_t now = count - first < BESIDE ? count - first : BESIDE, meet[BESIDE] = {0};
        double s[BESIDE], least[BESIDE], sum[2][BESIDE] = {{0.0}};
        for (int l = 0; l < BESIDE; l++) {
            s[l] = sigma[first + (l < now ? l : 0)];
            ahead[0][l] = behind[n - 1][l] = -s[l];
        }
        for (int64_t i = 0; i + 1 < n; i++) {
            double up = b[i] * b[i], down = b[n - 2 - i] * b[n - 2 - i];
            double *a = ahead[i], *z = behind[n - 1 - i];
            for (int l = 0; l < BESIDE; l++) a[BESIDE + l] = not_zero(-s[l] - up / a[l], s[l]);
            for (int l = 0; l < BESIDE; l++) z[l - BESIDE] = not_zero(-s[l] - down / z[l], s[l]);
        }
        for (int l = 0; l < BESIDE; l++) least[l] = INFINITY;
        for (int64_t i = 0; i < n; i++)
            for (int l = 0; l < BESIDE; l++) {
                double both = ahead[i][l] + behind[i][l] + s[l];
                if (fabs(both) < fabs(least[l])) { least[l] = both; meet[l] = i; }
            }
        for (int l = 0; l < now; l++) { /* the vector takes the place of `ahead` */
            double z = 1.0;
            for (int64_t i = meet[l] - 1; i >= 0; i--) {
                z *= -b[i] / ahead[i][l];
                ahead[i][l] = z;
                sum[i % 2][l] += z * z;
            }
            z = ahead[meet[l]][l] = 1.0;
            sum[meet[l] % 2][l] += 1.0;
            for (int64_t i = meet[l]; i + 1 < n; i++) {
                z *= -b[i] / behind[i + 1][l];
                ahead[i + 1][l] = z;
                sum[(i + 1) % 2][l] += z * z;
            }
            correction[first + l] = least[l] / (sum[0][l] + sum[1][l]);
        }
        if (!right) continue;
        for (int64_t i = 0; i < n; i++) {
            double *to = (i % 2 ? left : right) + place[i] * row + first;
            for (int l = 0; l < now; l++) to[l] = ahead[i][l] / sqrt(sum[i % 2][l]);
        }
    }
}
