/* Which vector unit calculates a start, alone or beside others. */
#ifndef TORSION_VECTOR_UNITS_H
#define TORSION_VECTOR_UNITS_H
#include "kernels.h"

/* Lanes that are calculated at once. */
#define MANY 4

/* Whether this machine has the wider registers for which a function marked WIDER is compiled. */
int has_wider(void);
#if defined(__x86_64__)
#define WIDER __attribute__((target("avx2")))
#else
#define WIDER
#endif
/* Compiled into a plain function and a WIDER one, which give the same bits. */
#define IN_BOTH static inline __attribute__((always_inline))

typedef void (*begin_t)(const system_t *, const drive_t *, const torques_t *, state_t *, samples_t *, double *);
typedef void (*advance_t)(stretches_t *, const system_t *, const drive_t *, const torques_t *, state_t *,
                          samples_t *, double *);
typedef struct { begin_t begin; advance_t advance; } loop_t;

extern const loop_t plain_one, wide_one, plain_lanes, wide_lanes;

/* The loop for this machine's vector unit and a number of lanes: each gives the same bits. */
const loop_t *widest(int64_t lanes);
#endif
