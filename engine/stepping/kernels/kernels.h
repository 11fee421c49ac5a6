/* What the compiled loops take: the one description, read by the compiler and by library.py.
 *
 * Arrays are of double or int64_t, C-contiguous; shapes stand beside them, and are checked as a struct is filled (library.py),
 * as is that what is read is finite, unless `infinite` or `nan` stands there. SI throughout. A force is a torque
 * at one station; `reach` maps forces to modes and modal to station angles alike. Nothing is allocated in a loop:
 * room to work in comes with the call. No global state.
 *
 * A start without events runs alone or beside others, one a lane. What varies by lane is marked (…; lanes): its last
 * axis are the lanes, one of them where a start runs alone, and in the loop with events.
 */
#ifndef TORSION_KERNELS_H
#define TORSION_KERNELS_H
#include <stdint.h>

/* Torque against speed as piecewise cubics, held constant outside their knots. */
typedef struct {
    int64_t n, longest;    /* curves of a lane; knots there is room for */
    const double *knots;   /* (lanes, n, longest) fraction of synchronous speed */
    const double *cubics;  /* (lanes, n, longest, 4) from each knot on [N m] */
    const int64_t *counts; /* (lanes, n) knots in use */
} curves_t;

/* Motors whose torque follows from their flux linkages; of the loop with events. */
typedef struct {
    int64_t n, most;                  /* motors; fluxes of each there is room for */
    const int64_t *motor;             /* (n) which of all */
    const int64_t *n_flux, *q;        /* (n) fluxes, axis d first; which is that of the stator's axis q */
    const int64_t *voltage;           /* (n) curve of the line's voltage against speed; -1: always 1 */
    const double *rate;               /* (n, most, most) of a rotor at rest [1/s] */
    const double *current;            /* (n, 2, most) currents of the stator's axes d and q */
    const double *field;              /* (n, most) from the voltage of the field [1/s] */
    const double *stator;             /* (n) 1, or 0 while it is open: neither voltage nor motion acts on it */
    const double *forward, *backward; /* (n, 2) voltage that turns with the line and against it: size, angle [1, rad] */
    const double *ramp;               /* (n, 2) voltage at closing, and until when it rises to the full one: 0: it does not [1, s] */
    const double *base;               /* (n) [N m] */
    double line_omega, frame;         /* of the voltage; electrical speed at which the train stands still [rad/s] */
    const int64_t *unlike;            /* (n) 1: the axes of the stator are connected unlike, by rows as of machine_t */
    const double *axis, *rows;        /* (n) angle of the first axis, as that of a voltage; (n, 2, 4) [rad; 1, s, 1, 1] */
    double *flux;                     /* (n, most) updated [pu] */
    const int64_t *watched;           /* (n) what has to stay positive: 0 nothing, 1 watch × fluxes, 2 × their rates */
    const double *watch;              /* (n, most) current or voltage of a field whose resistance changes with its sign */
} machines_t;

/* Motors, loads and torques against time. */
typedef struct {
    curves_t curves;
    machines_t machines;
    int64_t n_motors;
    const int64_t *motor_force, *average, *pulsating, *with_field; /* (n_motors) force; curves */
    const double *motor_speed, *pole_pairs;     /* (n_motors; lanes) [rad/s, 1] */
    const double *line_omega;                   /* (n_motors; lanes) halved with the pole pairs: 1 × slip [rad/s] */
    const double *shock, *shock_rate;           /* (n_motors; lanes) transient at breaker closing [N m, 1/s] */
    const double *shock_omega;                  /* (lanes) [rad/s] */
    const double *field_time, *field_rate;      /* (n_motors; lanes) infinite: none, at once [s, 1/s] */
    const double *pull_out, *cage, *polarity;   /* (n_motors; lanes) [N m, N m s/rad (nan: the curve), rad] */
    const double *connected;                    /* (n_motors; lanes) 0: tripped, in all lanes alike */
    int64_t n_loads;
    const int64_t *load_force, *load_curve;     /* (n_loads) */
    const double *load_speed, *soft_speed;      /* (n_loads; lanes) [rad/s] */
    int64_t n_timed, most_timed;
    const int64_t *timed_force;                 /* (n_timed) */
    const int64_t *timed_count;                 /* (lanes, n_timed) */
    const double *times, *torques;              /* (lanes, n_timed, most_timed) [s, N m] */
    int64_t n_tones;                            /* of the loop with events, which has one lane: A e^(−dt) cos(ωt + φ) */
    const int64_t *tone_force;                  /* (n_tones) */
    const double *tone_size, *tone_decay;       /* (n_tones) A, d [N m, 1/s] */
    const double *tone_omega, *tone_phase;      /* (n_tones) ω, φ [rad/s, rad] */
} drive_t;

/* Modes of one linear system. */
typedef struct {
    int64_t n, n_forces;
    const double *stiffness, *rate;  /* (n; lanes) λ and d [1/s², 1/s] */
    const double *reach;             /* (n_forces, n; lanes) [rad/√(kg m²)] */
    const double *mean_speed;        /* (n; lanes) mean speed from modal velocities */
    int64_t n_read;                  /* the first modes, on which the next depends */
    const double *read_speed;        /* (n_motors, n_read; lanes) speed at which its curves are read [√(1/(kg m²))] */
    int64_t n_swings, n_levels;      /* motors that answer oscillations; speeds of their tables, 0 to 1 */
    const int64_t *swing_motor;      /* (n_swings) */
    const double *swing;             /* (n_swings, n_levels, n; lanes) torque over modal velocity [N m s/√(kg m²)] */
    int64_t n_dampers;
    const int64_t *damper_force;     /* (n_dampers) */
    const double *viscous;           /* (n_dampers; lanes) [N m s/rad] */
} system_t;

/* State between two steps, updated. */
typedef struct {
    double *q, *v;               /* (n; lanes) modal position and velocity */
    double *phase;               /* (n_motors; lanes) of each pulsation, modulo 4π [rad] */
    double *force, *force_rate;  /* (n_forces; lanes) [N m, N m/s] */
} state_t;

/* A row a step of the loop with events. */
typedef struct {
    double *time, *speed;          /* (rows) [s, rad/s] */
    double *torque, *torque_rate;  /* (n_outputs, rows) [N m, N m/s] */
    double *bearing;               /* (n_bodies, rows) [N] */
    double *phase;                 /* (rows, n_motors) */
    double *air_gap;               /* (rows, n_machines, 2) torques from fluxes and their rates [N m, N m/s] */
    double *q, *v;                 /* (rows, n) modal state, or none */
    int64_t *piece;                /* (rows) whose modes these are, or none */
    int64_t rows;                  /* room */
} output_t;

/* Torques of elements as linear functions of modes, their velocities and forces. */
typedef struct {
    int64_t n;               /* outputs */
    const double *position;  /* (n, modes; lanes) [N m] */
    const double *velocity;  /* (n, modes; lanes) none: all zero [N m s] */
    const double *force;     /* (n, forces; lanes) [1] */
} torques_t;

/* What a start without events leaves: a row a step, and where it is wanted each turning point. */
typedef struct {
    int64_t rows, next;            /* room; the row to be written next, updated */
    double *time, *speed;          /* (rows; lanes) [s, rad/s] */
    double *torque, *torque_rate;  /* (n, rows; lanes), or none [N m, N m/s] */
    double *last_time;             /* (lanes) of the last row, updated [s] */
    double *last, *last_rate;      /* (n; lanes) its torques, updated */
    double *before, *before_rate;  /* (n; lanes) those of the row before it, updated */
    double *largest;               /* (n; lanes) magnitude so far, updated [N m] */
    int64_t room;                  /* turning points of a torque; 0: none are wanted */
    double *when, *value;          /* (n, lanes, room) [s, N m] */
    int64_t *count;                /* (n, lanes) how many, updated */
} samples_t;

/* Linear systems by contact state: one table entry a piece. */
typedef struct {
    int64_t n_pieces, n, n_forces, n_flanks, n_dampers, levels;
    const int64_t *keys;                          /* (n_pieces) loaded flanks, a bit each */
    const double *stiffness, *rate;               /* (n_pieces, n) */
    const double *reach;                          /* (n_pieces, n_forces, n) */
    const double *constant, *mean_speed;          /* (n_pieces, n) */
    const double *read_speed;                     /* (n_pieces, n_motors, n) */
    int64_t n_swings, n_swing_levels;
    const int64_t *swing_motor;                   /* (n_swings) */
    const double *swing;                          /* (n_pieces, n_swings, n_swing_levels, n) */
    const double *flank_rows;                     /* (n_pieces, n, n_flanks) */
    const double *viscous;                        /* (n_pieces, n_dampers) */
    const double *shows;                          /* (n_pieces, n) share of an answer's scale */
    const double *turns;                          /* (n_pieces, n, n) from the common basis */
    int64_t n_outputs, n_bodies;
    const double *position, *velocity;            /* (n_pieces, n, n_outputs) torques of modes [N m, N m s] */
    const double *direct, *offset;                /* (n_pieces, n_forces, n_outputs) [1], (n_pieces, n_outputs) [N m] */
    const int64_t *damped;                        /* (n_pieces) whether velocities count */
    const double *centres;                        /* (n_pieces, n, 2 n_bodies) where gears on bearings move */
    const double *bearing_stiffness, *bearing_damping; /* (n_bodies) [N/m, N s/m] */
    double *free, *forced, *solver;               /* (n_pieces, levels, 2, 2, n), (…, 2, 4, n), (…, 2 n_d, 2 n_d) */
    int64_t *made;                                /* (n_pieces, levels) 0: coefficients not made yet */
    const int64_t *damper_force;                  /* (n_dampers) */
} pieces_t;

/* Modes without coupling under torques that are polynomials of s = t/h over each step. */
typedef struct {
    int64_t n, n_torques, terms;     /* modes, torques, coefficients of each torque over a step: 1 to 4 */
    const double *stiffness, *rate;  /* (n) λ and d [1/s², 1/s] */
    const double *reach;             /* (n, n_torques) [rad/√(kg m²)] */
} prescribed_t;

/* A motor on a train in time, over steps of one length. Points of a step: its beginning, middle and end. */
typedef struct {
    int64_t n_blocks, block;     /* groups of modes that damping couples; state of each, positions before velocities */
    const double *free;          /* (n_blocks, block, block) over the step */
    const double *forced;        /* (n_blocks, block, 3) from torques at the points */
    const double *rotor;         /* (2, n_blocks block) angle and speed of the rotor */
    const double *rotor_free;    /* (4, n_blocks block) angle and speed of the rotor in the middle, and at the end */
    const double *rotor_forced;  /* (4, 3) */
    int64_t n_flux, q;           /* flux linkages, d first; which is that of the stator's axis q */
    const double *flux_free;     /* (2, n_flux, n_flux) to the middle, and to the end */
    const double *flux_forced;   /* (2, n_flux, 3, 2) from inputs of the axes d and q at the points */
    const double *flux_steady;   /* (2, n_flux) from the voltage of the field */
    const double *current;       /* (2, n_flux) currents of the stator's axes d and q */
    double line_omega, axes_speed; /* [rad/s], of the axes in which fluxes advance by `flux_free` [1] */
    double pole_pairs, torque_base, held; /* [1, N m, N m]; the torque that the train is in balance with */
    double angle;                /* of axis d against the line at t = 0, the train in balance [rad] */
    double forward[2], backward[2]; /* voltages that turn with the line and against it: size, angle at t = 0 [1, rad] */
    /* Where the terminals of two axes of the stator are unlike, rows (p, x, m, r) of each: p u + x di/dt = m e − r i, of its
     * voltage u, current i and the source's voltage e. Along a shorted one u is zero, and along one behind a line u is what
     * is left of e. Angle of the first axis, as those above [rad], and rates of the currents d and q per flux linkage, from
     * the field, and per voltage d and q. None: they are alike. */
    const double *current_rate;     /* (2, n_flux + 3) */
    const double *rows;             /* (2, 4) [1, s, 1, 1] */
    double axis;
} machine_t;

/* Flanks: all drive flanks, then all back flanks. */
typedef struct {
    const double *gap;                                /* (n_flanks) infinite: never met [rad] */
    const double *stiffness, *damping, *scale;        /* (n_flanks) [N m/rad, N m s/rad, N m] */
    int64_t limited;                                  /* contact damping never exceeds the spring force */
    int64_t *contact;                                 /* (n_flanks) updated */
    int64_t piece;                                    /* present piece, updated; -1: has to be made */
} flanks_t;

/* Time, what the loop stops at, and how it samples. */
typedef struct {
    double time;                     /* updated [s] */
    int64_t fresh;                   /* 1: forces have to be evaluated anew, 2: and written as a row */
    double end_time, base_step;      /* [s] */
    int64_t n_stops, stop;           /* times at which a step has to end; the next one, updated */
    const double *stops;             /* (n_stops) rising [s] */
    double visible;                  /* ringing above this share is resolved [1] */
    double rising, falling, angle;   /* mean speeds and load angle to stop at (nan: none) [rad/s, rad] */
    double sampled;                  /* angular frequency that the base step samples [rad/s] */
    int64_t turned;                  /* motor in time whose field current has changed its sign, updated */
} clock_t_;

/* Events: time, clearance, contact before and after, speed of the flank. */
typedef struct {
    double *log;       /* (room, 5) */
    int64_t room, n;   /* rows; rows written */
} log_t;

/* Steps of starts without events: stretches of equal ones. */
typedef struct {
    int64_t newmark;             /* 1: average acceleration; 0: exponential */
    int64_t most;                /* stretches there is room for */
    const int64_t *n;            /* (lanes) stretches */
    const int64_t *counts;       /* (lanes, most) steps of each */
    const double *steps;         /* (lanes, most) length of each [s] */
    const double *target_speed;  /* (lanes) mean speed at which to stop, infinite: none [rad/s] */
    int64_t *at, *taken;         /* (lanes) present stretch and its steps taken, updated */
    double *time;                /* (lanes) at the beginning of the stretch, updated [s] */
    int64_t *reason;             /* (lanes) why it ended; MORE: it goes on; updated */
    int64_t *done;               /* (lanes) rows that hold its samples */
} stretches_t;

/* Why a loop came back: room is full, end time, speed reached, load angle reached, a piece has to be made, no
 * progress, damper forces without a solution in double precision, torque of a motor and its motion that do not settle
 * in a step. */
enum { MORE, AT_TIME, SPEED, ANGLE, NEW_PIECE, STUCK, DIVIDED, UNSETTLED, TURNED };

int64_t linear_room(int64_t lanes, const system_t *system, const drive_t *drive, const torques_t *torques);
int64_t contact_room(const pieces_t *pieces, const drive_t *drive);
void start_forces(double t, double inside, const double *phase, const double *speed,
                  const double *acceleration, const double *read, const double *read_rate, const drive_t *drive,
                  const system_t *system, double *room,
                  double *force, double *force_rate);
/* Of starts without events, and how many lanes are calculated at once; lanes: how many the arrays have. */
int64_t lanes_at_once(void);
void begin_starts(int64_t lanes, const system_t *system, const drive_t *drive, const torques_t *torques,
                  state_t *state, samples_t *out, double *room);
void advance_starts(int64_t lanes, stretches_t *plan, const system_t *system, const drive_t *drive,
                    const torques_t *torques, state_t *state, samples_t *out, double *room);
int64_t advance_pieces(clock_t_ *clock, const pieces_t *pieces, flanks_t *flanks, const drive_t *drive,
                       state_t *state, output_t *out, log_t *log, double *room, int64_t *done);
void polynomial_step(int64_t n, const double *stiffness, const double *rate, double h, double *free,
                     double *forced);
void exponential_step(int64_t n, const double *stiffness, const double *rate, double h, double *free,
                      double *forced);
void newmark_step(int64_t n, const double *stiffness, const double *rate, double h, double *free,
                  double *forced);
double first_fall(double g0, double d0, double g1, double d1);
int64_t prescribed_room(const prescribed_t *p);
void drive_modes(const prescribed_t *p, int64_t n_steps, const double *steps, const double *torque, double *q,
                 double *v, int64_t n_times, int64_t first, double *out, double *room);
void drive_coupled(int64_t n_steps, int64_t n_state, int64_t n_push, const double *free, const double *push,
                   const double *torque, double *state, double *out, double *room);
int64_t machine_room(const machine_t *machine);
int64_t advance_machine(int64_t n_steps, double time, double h, const machine_t *machine, double *state, double *flux,
                        double *room); /* (n_steps + 1, …), the first row given; steps made */
int64_t turning_points(int64_t n, const double *t, const double *y, const double *slope, double *when,
                       double *value);
void samples_to_end(int64_t n_outputs, int64_t n, const double *t, const double *torque, const double *rate, double end,
                    double *room, double *to_when, double *to_value, int64_t *to_count);
double difference_of_extremes(int64_t n, const double *when, const double *value, int64_t m, const double *other_when,
                              const double *other_value, int64_t with_impacts, double guard_share, double same_until);
int64_t turning_to_end(int64_t n, const double *when, const double *value, double size, double first, double end,
                       const double *last, double *to_when, double *to_value);
void lane_to_end(int64_t n, int64_t lanes, int64_t lane, const samples_t *out, const double *first, const double *time,
                 double end, int64_t longest, double *to_when, double *to_value, int64_t *to_count);
int64_t reversals(int64_t n, const double *x, double *point);
int64_t rainflow(int64_t n, const double *point, int64_t *first, int64_t *second, double *count,
                 int64_t *open);
const char *about(void); /* compiler, target, digest of the sources */
/* Numbers and small matrices in a fixed order (engine/numerics/same_bits.py). */
enum { SINE, COSINE, EXPONENTIAL, LOGARITHM, POWER, ARCTANGENT, HYPOTENUSE };
double function_of(int64_t which, double x, double y);
void function_values(int64_t which, int64_t n, const double *x, int64_t x_step, const double *y, int64_t y_step,
                     double *out);
void interpolate(int64_t n, const double *x, int64_t n_points, const double *points, const double *values,
                 double *out);
void curve_through(int64_t n, const double *x, const double *y, double *cubics);
void curve_values(int64_t n_knots, const double *knots, const double *cubics, int64_t n, const double *x, double *out);
double curve_steepest(int64_t n_knots, const double *knots, const double *cubics);
void fading_sum(int64_t n, double share, double *values);
void product(int64_t m, int64_t n, int64_t k, const double *a, const double *b, double *c);
int64_t jacobi_svd(int64_t m, int64_t n, double *columns, double *left, double *sigma, double *right,
                   int64_t *order, double *room);
int64_t solve_real(int64_t n, int64_t r, double *a, double *b);
int64_t factor_complex(int64_t count, int64_t n, const double *a, double *f, int64_t *rows);
void solve_complex(int64_t count, int64_t n, int64_t r, const double *a, const double *f, const int64_t *rows,
                   double *b, double *room);
int64_t eigenvalues(int64_t n, double *a, double *real, double *imaginary);
/* Long unbranched trains (engine/numerics/singular_values.py). */
void chain_vectors(int64_t n, const double *b, int64_t count, const double *sigma, double *correction,
                   const int64_t *place, int64_t row, double *right, double *left, double *room);
#endif
