/* A machine on which no thread begins (APA_NO_THREADS) or no process (APA_NO_PROCESSES), or whose clock is wrong by
 * APA_CLOCK_OFFSET [s] and runs APA_CLOCK_RATE times as fast, backwards if that is below 0. */

#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/types.h>
#include <time.h>
#include <unistd.h>

int pthread_create(pthread_t *thread, const pthread_attr_t *how, void *(*begin)(void *), void *given) {
    if (getenv("APA_NO_THREADS")) return EAGAIN;
    int (*next)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *);
    *(void **)&next = dlsym(RTLD_NEXT, "pthread_create");
    return next(thread, how, begin, given);
}

pid_t fork(void) {
    if (getenv("APA_NO_PROCESSES")) {
        errno = EAGAIN;
        return -1;
    }
    pid_t (*next)(void);
    *(void **)&next = dlsym(RTLD_NEXT, "fork");
    return next();
}

pid_t vfork(void) { return fork(); }

static double shown(double now) {
    static double begun;
    const char *offset = getenv("APA_CLOCK_OFFSET"), *rate = getenv("APA_CLOCK_RATE");
    if (begun == 0.0) begun = now;
    return begun + (offset ? atof(offset) : 0.0) + (now - begun) * (rate ? atof(rate) : 1.0);
}

int clock_gettime(clockid_t clock, struct timespec *time) {
    const int code = (int)syscall(SYS_clock_gettime, clock, time);
    if (code || (clock != CLOCK_REALTIME && clock != CLOCK_REALTIME_COARSE)) return code;
    const double now = shown((double)time->tv_sec + 1e-9 * (double)time->tv_nsec);
    time->tv_sec = (time_t)now - (now < (double)(time_t)now);
    time->tv_nsec = (long)(1e9 * (now - (double)time->tv_sec));
    return 0;
}

int gettimeofday(struct timeval *restrict time, void *restrict zone) {
    (void)zone;
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    time->tv_sec = now.tv_sec;
    time->tv_usec = now.tv_nsec / 1000;
    return 0;
}

time_t time(time_t *place) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    if (place) *place = now.tv_sec;
    return now.tv_sec;
}
