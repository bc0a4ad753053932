/* Loops over functions of the vehicle's C, for bench_vehicle.py. */
#include "Vehicle.c"

#ifdef _WIN32
#define BENCH __declspec(dllexport)
#else
#define BENCH __attribute__((visibility("default")))
#endif

static Vehicle bench_car(void) {
    Vehicle vehicle = {0};
    Vehicle_defaults(&vehicle.params, &vehicle.inputs);
    return vehicle;
}

static const KinematicInput bench_held = {1.0, 0.2};
static const Motion bench_motion = {{0.0, 0.0, 0.0}, 1.0, 0.0, 0.0};
static const Effort bench_effort = {200.0, 0.0};
static const Wheel bench_wheel = {1.0 / 0.344};

/* Each does n steps of 1 ms, an even number, and returns a number of the last, so that none can be left out. */
BENCH double bench_kinematic(int64_t n) {
    KinematicState state = {.cos = 1.0};
    for (int64_t k = 0; k < n; k++) state = move(&state, &bench_held, &bench_held, 2.405, 0.001);
    return state.pose.x;
}

BENCH double bench_single_track(int64_t n) {
    const Vehicle car = bench_car();
    const VehicleParams *p = &car.params;
    const Build build = {{2.405, 1.40}, p->chassis, p->road};
    SingleTrackState state = {.motion = bench_motion}, next;
    for (int64_t k = 0; k < n; k += 2) {
        step_single_track(&state, 0.2, &bench_effort, &build, &p->single_track, 0.001, &next);
        step_single_track(&next, 0.2, &bench_effort, &build, &p->single_track, 0.001, &state);
    }
    return state.motion.pose.x;
}

BENCH double bench_double_track(int64_t n) {
    const Vehicle car = bench_car();
    const VehicleParams *p = &car.params;
    const Build build = {{2.405, 1.40}, p->chassis, p->road};
    DoubleTrackState state = {.motion = bench_motion}, next;
    for (int64_t k = 0; k < 4; k++) state.wheels[k] = bench_wheel;
    for (int64_t k = 0; k < n; k += 2) {
        step_double_track(&state, 0.2, &bench_effort, &build, &p->double_track, 0.001, &next);
        step_double_track(&next, 0.2, &bench_effort, &build, &p->double_track, 0.001, &state);
    }
    return state.motion.pose.x;
}

/* n steps of 10 ms of the whole vehicle, driven forward with the wheel held. */
BENCH double bench_vehicle(int64_t n, int64_t body, int64_t prompt) {
    Vehicle car = bench_car();
    car.params.body = body;
    car.inputs.steering_wheel_request = 3.0;
    car.inputs.steering_active = true;
    car.inputs.prompt = prompt;
    Vehicle_initialize(&car.params, &car.state, &car.outputs);
    for (int64_t k = 0; k < n; k++) Vehicle_step(&car.state, &car.inputs, &car.params, 10000000, &car.outputs);
    return car.outputs.pose.x;
}
