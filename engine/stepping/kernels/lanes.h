/* Numbers of several cases side by side: `lane_t` is one double, or LANES of them in the vector unit.
 *
 * A source that is written on lane_t is compiled once with one lane and once with many. Each lane goes through the
 * same operations in the same order, so a case gives the same bits alone and beside others.
 */
#ifndef TORSION_LANES_H
#define TORSION_LANES_H
#include <math.h>
#include <stdint.h>

#ifndef LANES
#define LANES 1
#endif

#if LANES == 1
typedef double lane_t;
typedef int64_t mask_t; /* not zero: true */
#define AT(lanes, l) (lanes)
static inline int any(mask_t m) { return m != 0; }
static inline lane_t choose(mask_t m, lane_t a, lane_t b) { return m ? a : b; }
static inline lane_t magnitude(lane_t a) { return fabs(a); }
#else
/* As wide as all lanes, at any address. */
typedef double lane_t __attribute__((vector_size(8 * LANES), aligned(8), may_alias));
typedef int64_t mask_t __attribute__((vector_size(8 * LANES), aligned(8), may_alias)); /* all bits: true */
#define AT(lanes, l) ((lanes)[l])
static inline int any(mask_t m)
{
    int64_t both = 0;
    for (int l = 0; l < LANES; l++) both |= m[l];
    return both != 0;
}
static inline lane_t choose(mask_t m, lane_t a, lane_t b)
{
    return (lane_t)(((mask_t)a & m) | ((mask_t)b & ~m));
}
static inline lane_t magnitude(lane_t a) { return (lane_t)((mask_t)a & INT64_MAX); }
#endif

/* Every lane the same. */
static inline lane_t all(double x) { return x + (lane_t){0.0}; }
/* An array of doubles whose last axis are the lanes. */
static inline const lane_t *lanes_of(const double *array) { return (const lane_t *)array; }
#endif
