/* Turning points of a cubic through values and rates at both ends of a step. */
#ifndef TORSION_TURNING_H
#define TORSION_TURNING_H
#include "lanes.h"

/* Where a curve turns within a step: at most twice. */
typedef struct { mask_t is[2]; lane_t when[2], value[2]; } turning_t;

static inline lane_t square_root(lane_t x)
{
    lane_t root;
    for (int l = 0; l < LANES; l++) AT(root, l) = sqrt(AT(x, l));
    return root;
}

/* Zeros of the derivative d0 + b s + c s² of the cubic, s = 0 … 1, in rising order. */
static inline turning_t turning_of_step(lane_t t, lane_t h, lane_t y, lane_t rise, lane_t rate0, lane_t rate1)
{
    const lane_t d0 = h * rate0, d1 = h * rate1;
    const lane_t b = 6.0 * rise - 4.0 * d0 - 2.0 * d1, c = 3.0 * (d0 + d1) - 6.0 * rise;
    const lane_t disc = b * b - 4.0 * c * d0, root = square_root(disc);
    const lane_t w = choose(b >= 0.0, -0.5 * (b + root), -0.5 * (b - root));
    const lane_t p = choose(w != 0.0, d0 / w, all(-1.0)), q = choose(c != 0.0, w / c, all(-1.0));
    turning_t turning;
    for (int j = 0; j < 2; j++) {
        lane_t s = choose(p > q, j ? p : q, j ? q : p);
        turning.is[j] = (disc > 0.0) & (s >= -1e-12) & (s <= 1.0 + 1e-12);
        s = choose(s < 0.0, all(0.0), choose(s > 1.0, all(1.0), s));
        turning.when[j] = t + s * h;
        turning.value[j] = y + s * (d0 + s * (0.5 * b + s * c / 3.0));
    }
    return turning;
}

/* Lanes whose torque may turn within the step. The Bernstein coefficients of the derivative bound it: where all
 * three are of one sign, by more than rounding, it has no zero. */
static inline mask_t may_turn(lane_t h, lane_t rise, lane_t rate0, lane_t rate1)
{
    const lane_t d0 = h * rate0, d1 = h * rate1, middle = 3.0 * rise - d0 - d1;
    const lane_t least = 1e-9 * (magnitude(d0) + magnitude(d1) + magnitude(middle));
    const mask_t rises = (d0 > least) & (d1 > least) & (middle > least);
    const mask_t falls = (d0 < -least) & (d1 < -least) & (middle < -least);
    return (rises | falls) == 0;
}
#endif
