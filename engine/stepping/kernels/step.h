/* One exponential step of one mode: exact for the structure, cubic in the force (see ../exponential.py). */
#ifndef TORSION_STEP_H
#define TORSION_STEP_H
#include "elementary.h"

/* φ₁ … φ₄ at −x for x below 1, by their Taylor series. */
static inline double phi_series(double x, int k, double factorial)
{
    double term = 1.0 / factorial, total = term;
    for (int n = 1; n < 20; n++) {
        term *= -x / (double)(k + n);
        total += term;
    }
    return total;
}

/* φ₀ … φ₄ at −x for x ≥ 0. */
static inline void phi(double x, double found[5])
{
    static const double factorial[5] = {1.0, 1.0, 2.0, 6.0, 24.0};
    found[0] = exponential(-x);
    for (int k = 1; k < 5; k++)
        found[k] = x >= 1.0 ? (1.0 / factorial[k - 1] - found[k - 1]) / x : phi_series(x, k, factorial[k]);
}

/* Answers of ẍ + D ẋ + L x = s^j at s = 1, from rest, for j = 0 … 3, by their Taylor series. */
static inline void series_response(double L, double D, double response[2][4])
{
    double x[4] = {0}, y[4] = {0}, before[4] = {0}, last[4] = {0};
    for (int k = 0; k < 60; k++) {
        double size = (double)((k + 2) * (k + 1)), more = (double)(k + 2), largest = 0.0;
        for (int j = 0; j < 4; j++) {
            double next = (-D * (double)(k + 1) * last[j] - L * before[j] + (k == j ? 1.0 : 0.0)) / size;
            double both = fabs(next) + fabs(last[j]);
            x[j] += next;
            y[j] += more * next;
            before[j] = last[j];
            last[j] = next;
            largest = both > largest ? both : largest;
        }
        if (k > 4 && largest < 1e-19) break;
    }
    for (int j = 0; j < 4; j++) {
        response[0][j] = x[j];
        response[1][j] = y[j];
    }
}

/* sinh γ / γ and cosh γ for γ² below 1. */
static inline void hyperbolic(double square, double *bend, double *rise)
{
    double odd = 1.0, even = 1.0;
    *bend = *rise = 1.0;
    for (int k = 1; k < 12; k++) {
        even *= square / (double)((2 * k - 1) * (2 * k));
        odd *= square / (double)((2 * k) * (2 * k + 1));
        *rise += even;
        *bend += odd;
    }
}

/* Two real exponents well apart. Returns the free motion: f00, f01, f11. */
static inline void apart_step(double L, double a, double free[3], double response[2][4])
{
    static const double factorial[4] = {1.0, 1.0, 2.0, 6.0};
    double fast = a + sqrt(a * a - L), slow = L / fast, gap = fast - slow;
    double late[5], early[5];
    phi(slow, late);
    phi(fast, early);
    free[0] = (fast * late[0] - slow * early[0]) / gap;
    free[1] = (late[0] - early[0]) / gap;
    free[2] = (fast * early[0] - slow * late[0]) / gap;
    for (int j = 0; j < 4; j++) {
        response[0][j] = factorial[j] * (late[j + 1] - early[j + 1]) / gap;
        response[1][j] = factorial[j] * (late[j] - early[j]) / gap;
    }
}

/* Oscillation, or two exponents close together. */
static inline void near_step(double L, double D, double a, double free[3], double response[2][4])
{
    double square = L - a * a, decay = exponential(-a), cosine, sine;
    if (square >= 0.0) {
        double beta = sqrt(square);
        sincos_t wave = sin_cos(beta);
        cosine = decay * wave.cosine;
        sine = decay * (beta > 1e-8 ? wave.sine / beta : 1.0);
    } else {
        double bend, rise;
        hyperbolic(-square, &bend, &rise);
        cosine = decay * rise;
        sine = decay * bend;
    }
    free[0] = cosine + a * sine;
    free[1] = sine;
    free[2] = cosine - a * sine;
    if (L > 4.0) { /* the equation itself links the answers */
        double before = free[2], last = sine, factorial = 1.0;
        for (int j = 0; j < 4; j++) {
            double next;
            if (j > 1) factorial *= (double)j;
            response[1][j] = factorial * last;
            next = (1.0 / factorial - D * last - before) / L;
            before = last;
            last = next;
            response[0][j] = factorial * last;
        }
    } else {
        series_response(L, D, response);
    }
}

/* Map of the state (q, q̇) and of the force over one step. */
typedef struct { double free[2][2], forced[2][4]; } map_t;

/* With the force as a cubic in s = t/h: the map of its coefficients. */
static inline map_t polynomial_map(double stiffness, double rate, double h)
{
    double L = stiffness * h * h, D = rate * h, a = 0.5 * D, own[3];
    map_t map;
    if (a * a - L >= 1.0) apart_step(L, a, own, map.forced);
    else near_step(L, D, a, own, map.forced);
    map.free[0][0] = own[0];
    map.free[0][1] = h * own[1];
    map.free[1][0] = -L * own[1] / h;
    map.free[1][1] = own[2];
    for (int j = 0; j < 4; j++) {
        map.forced[0][j] *= h * h;
        map.forced[1][j] *= h;
    }
    return map;
}

/* With the force by its values and rates at both ends: the map of (u₀, u̇₀, u₁, u̇₁). */
static inline map_t exponential_map(double stiffness, double rate, double h)
{
    map_t map = polynomial_map(stiffness, rate, h);
    for (int i = 0; i < 2; i++) {
        double *c = map.forced[i], c0 = c[0], c1 = c[1], c2 = c[2], c3 = c[3];
        c[0] = c0 - 3.0 * c2 + 2.0 * c3;
        c[1] = h * (c1 - 2.0 * c2 + c3);
        c[2] = 3.0 * c2 - 2.0 * c3;
        c[3] = h * (c3 - c2);
    }
    return map;
}

/* Average acceleration (see ../newmark.py); the rates have no weight. */
static inline map_t newmark_map(double stiffness, double rate, double h)
{
    double damped = 0.5 * h * rate, stiff = 0.25 * h * h * stiffness, weight = 1.0 / (1.0 + damped + stiff);
    map_t map = {{{(1.0 + damped - stiff) * weight, h * weight},
                  {-h * stiffness * weight, (1.0 - damped - stiff) * weight}},
                 {{0.25 * h * h * weight, 0.0, 0.25 * h * h * weight, 0.0},
                  {0.5 * h * weight, 0.0, 0.5 * h * weight, 0.0}}};
    return map;
}

/* Coefficients of one mode of n, in one of several lanes; the modes along the last axis but that of the lanes. */
static inline void put_map(const map_t *map, int64_t n, int64_t i, int64_t lanes, int64_t lane, double *free,
                           double *forced)
{
    for (int a = 0; a < 2; a++) {
        for (int b = 0; b < 2; b++) free[((2 * a + b) * n + i) * lanes + lane] = map->free[a][b];
        for (int b = 0; b < 4; b++) forced[((4 * a + b) * n + i) * lanes + lane] = map->forced[a][b];
    }
}
#endif
