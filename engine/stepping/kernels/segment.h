/* Where a number lies between the rising points of a table. */
#ifndef TORSION_SEGMENT_H
#define TORSION_SEGMENT_H
#include <stdint.h>

/* Segment of a table that holds x, which lies within it. */
static inline int64_t segment(const double *knots, int64_t count, double x)
{
    int64_t low = 0, high = count - 1;
    while (high - low > 1) {
        int64_t middle = (low + high) / 2;
        if (knots[middle] <= x) low = middle;
        else high = middle;
    }
    return low;
}
#endif
