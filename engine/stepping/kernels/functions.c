/* Functions of arrays: elementary ones, and straight lines between points. */
#include "kernels.h"
#include "elementary_more.h"
#include "segment.h"

double function_of(int64_t which, double x, double y)
{
    int finite = x - x == 0.0;
    switch (which) {
    case SINE: return finite ? sin_cos(x).sine : x - x;
    case COSINE: return finite ? sin_cos(x).cosine : x - x;
    case EXPONENTIAL: return exponential(x);
    case LOGARITHM: return logarithm(x);
    case POWER: return power(x, y);
    case ARCTANGENT: return arctangent(x, y);
    default: return hypotenuse(x, y);
    }
}

/* out = f(x) or f(x, y); x and y of n numbers, or of one where their step is 0. */
void function_values(int64_t which, int64_t n, const double *x, int64_t x_step, const double *y, int64_t y_step,
                     double *out)
{
    for (int64_t i = 0; i < n; i++) out[i] = function_of(which, x[i * x_step], y[i * y_step]);
}

/* Straight lines between points (n_points), held outside them. */
void interpolate(int64_t n, const double *x, int64_t n_points, const double *points, const double *values, double *out)
{
    int64_t k = 0;
    for (int64_t i = 0; i < n; i++) {
        double at = x[i], slope;
        if (k + 2 < n_points && points[k + 1] <= at && at < points[k + 2]) k++; /* places often rise as the points do */
        if (!(k + 1 < n_points && points[k] <= at && at < points[k + 1])) k = segment(points, n_points + 1, at);
        if (at != at) {
            out[i] = at;
        } else if (at <= points[0]) {
            out[i] = values[0];
        } else if (k + 1 >= n_points || at == points[k]) {
            out[i] = values[k];
        } else {
            slope = (values[k + 1] - values[k]) / (points[k + 1] - points[k]);
            out[i] = slope * (at - points[k]) + values[k];
        }
    }
}

/* Each value and what is left of those before it. */
void fading_sum(int64_t n, double share, double *values)
{
    for (int64_t i = 1; i < n; i++) values[i] += share * values[i - 1];
}
