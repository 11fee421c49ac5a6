/* A single start, with the vector instructions that every machine of this kind has. */
#include "vector_units.h"

#define ROWS MANY
#define BEGIN begin_plain
#define ADVANCE advance_plain
#include "linear_body.h"

const loop_t plain_one = {begin_plain, advance_plain};
