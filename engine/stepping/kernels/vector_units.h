/* Starts side by side: which vector unit calculates them. */
#ifndef TORSION_VECTOR_UNITS_H
#define TORSION_VECTOR_UNITS_H
#include "kernels.h"

/* Lanes that are calculated at once. */
#define MANY 4

typedef void (*begin_t)(const system_t *, const drive_t *, const torques_t *, state_t *, samples_t *, double *);
typedef void (*advance_t)(stretches_t *, const system_t *, const drive_t *, const torques_t *, state_t *,
                          samples_t *, double *);
typedef struct { begin_t begin; advance_t advance; } side_by_side_t;

extern const side_by_side_t plain_lanes, wide_lanes;

/* The loop for this machine's vector unit: each gives the same bits. */
const side_by_side_t *widest(void);
#endif
