/* Turning points of a cubic through values and rates at both ends of a step. */
#ifndef TORSION_TURNING_H
#define TORSION_TURNING_H
#include "lanes.h"

/* Where a curve turns within a step: at most twice. */
typedef struct { wide_mask_t is[2]; wide_t when[2], value[2]; } turning_t;

static inline wide_t square_root(wide_t x)
{
    wide_t root;
    for (int l = 0; l < WIDTH; l++) IN(root, l) = sqrt(IN(x, l));
    return root;
}

/* Zeros of the derivative d0 + b s + c s² of the cubic, s = 0 … 1, in rising order. */
static inline turning_t turning_of_step(wide_t t, wide_t h, wide_t y, wide_t rise, wide_t rate0, wide_t rate1)
{
    const wide_t d0 = h * rate0, d1 = h * rate1;
    const wide_t b = 6.0 * rise - 4.0 * d0 - 2.0 * d1, c = 3.0 * (d0 + d1) - 6.0 * rise;
    const wide_t disc = b * b - 4.0 * c * d0, root = square_root(disc);
    const wide_t w = choose_wide(b >= 0.0, -0.5 * (b + root), -0.5 * (b - root));
    const wide_t p = choose_wide(w != 0.0, d0 / w, spread(all(-1.0))), q = choose_wide(c != 0.0, w / c, spread(all(-1.0)));
    turning_t turning;
    for (int j = 0; j < 2; j++) {
        wide_t s = choose_wide(p > q, j ? p : q, j ? q : p);
        turning.is[j] = (disc > 0.0) & (s >= -1e-12) & (s <= 1.0 + 1e-12);
        s = choose_wide(s < 0.0, spread(all(0.0)), choose_wide(s > 1.0, spread(all(1.0)), s));
        turning.when[j] = t + s * h;
        turning.value[j] = y + s * (d0 + s * (0.5 * b + s * c / 3.0));
    }
    return turning;
}

/* Where a torque may turn within the step. The Bernstein coefficients of the derivative bound it: where all
 * three are of one sign, by more than rounding, it has no zero. */
static inline wide_mask_t may_turn(wide_t h, wide_t rise, wide_t rate0, wide_t rate1)
{
    const wide_t d0 = h * rate0, d1 = h * rate1, middle = 3.0 * rise - d0 - d1;
    const wide_t least = 1e-9 * (magnitude_wide(d0) + magnitude_wide(d1) + magnitude_wide(middle));
    const wide_mask_t rises = (d0 > least) & (d1 > least) & (middle > least);
    const wide_mask_t falls = (d0 < -least) & (d1 < -least) & (middle < -least);
    return (rises | falls) == 0;
}
#endif
