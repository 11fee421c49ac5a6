/* Numbers of several cases side by side: `lane_t` is one double, or LANES of them in the vector unit.
 *
 * A source that is written on lane_t is compiled once with one lane and once with many. Each lane goes through the
 * same operations in the same order, so a case gives the same bits alone and beside others. Where a case runs alone,
 * what it does to several modes, or sums along several rows of a matrix, is done ROWS at a time: `wide_t` is ROWS
 * numbers of one lane, or one number of each lane.
 */
#ifndef TORSION_LANES_H
#define TORSION_LANES_H
#include <math.h>
#include <stdint.h>

#ifndef LANES
#define LANES 1
#endif
#ifndef ROWS
#define ROWS 1
#endif
#define WIDTH (LANES * ROWS)

/* Numbers side by side, at any address; in a truth all bits mean true. */
#define SIDE_BY_SIDE(count, number, truth, any, choose, magnitude)                                             \
    typedef double number __attribute__((vector_size(8 * (count)), aligned(8), may_alias));                    \
    typedef int64_t truth __attribute__((vector_size(8 * (count)), aligned(8), may_alias));                    \
    static inline int any(truth m)                                                                             \
    {                                                                                                          \
        int64_t some = 0;                                                                                      \
        for (int l = 0; l < (count); l++) some |= m[l];                                                        \
        return some != 0;                                                                                      \
    }                                                                                                          \
    static inline number choose(truth m, number a, number b)                                                   \
    {                                                                                                          \
        return (number)(((truth)a & m) | ((truth)b & ~m));                                                     \
    }                                                                                                          \
    static inline number magnitude(number a) { return (number)((truth)a & INT64_MAX); }

#if LANES == 1
typedef double lane_t;
typedef int64_t mask_t; /* not zero: true */
#define AT(lanes, l) (lanes)
static inline int any(mask_t m) { return m != 0; }
static inline lane_t choose(mask_t m, lane_t a, lane_t b) { return m ? a : b; }
static inline lane_t magnitude(lane_t a) { return fabs(a); }
#else
SIDE_BY_SIDE(LANES, lane_t, mask_t, any, choose, magnitude)
#define AT(lanes, l) ((lanes)[l])
#endif

#if ROWS == 1
typedef lane_t wide_t;
typedef mask_t wide_mask_t;
#define IN(wide, k) AT(wide, k)
#define any_wide any
#define choose_wide choose
#define magnitude_wide magnitude
#else
SIDE_BY_SIDE(WIDTH, wide_t, wide_mask_t, any_wide, choose_wide, magnitude_wide)
#define IN(wide, k) ((wide)[k])
#endif

#define NO_LANE ((mask_t){0})
/* Every lane the same. */
static inline lane_t all(double x) { return x + (lane_t){0.0}; }
/* A number of each lane, ROWS times. */
#if ROWS == 1
static inline wide_t spread(lane_t x) { return x; }
#else
static inline wide_t spread(lane_t x) { return x + (wide_t){0.0}; }
#endif
/* An array of doubles whose last axis are the lanes. */
static inline const lane_t *lanes_of(const double *array) { return (const lane_t *)array; }
#endif
