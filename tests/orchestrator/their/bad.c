/* An FMI 2.0 FMU that does what its GUID says: crashes, hangs, leaves, refuses, at a place of its own. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <signal.h>
#include <unistd.h>
#ifdef _WIN32
#define FMI __declspec(dllexport)
#else
#define FMI __attribute__((visibility("default")))
#endif
typedef unsigned int ref;
typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);
typedef struct { Logger logger; void *allocate, *free, *finished, *environment; } Callbacks;
enum { OKAY, WARNING, DISCARD, BAD, FATAL };
static char fault[64];
static int is_dead;
static double output;
static long ignored;
static char *volatile kept[64];
static char text[1 << 22];
static const Callbacks *callbacks;

static int is(const char *what) { return strcmp(fault, what) == 0; }
static int deep(int n) { volatile char room[1 << 16]; room[0] = (char)n; return deep(n + 1) + room[0]; }
static int at(const char *place) {
    const char *rest = fault + strlen(place) + 1;
    if (is_dead) abort(); /* called after fmi2Fatal */
    if (strncmp(fault, place, strlen(place)) != 0) return OKAY;
    if (!strcmp(rest, "crash")) *(volatile int *)0 = 1;
    if (!strcmp(rest, "hang")) for (;;) sleep(1);
    if (!strcmp(rest, "exit")) exit(0);
    if (!strcmp(rest, "abort")) { fprintf(stderr, "terminate called: no reason\n"); abort(); }
    if (!strcmp(rest, "overflow")) return deep(0);
    if (!strcmp(rest, "close")) for (int i = 3; i < 1024; i++) close(i);
    if (!strcmp(rest, "low")) for (int i = 3; i < 12; i++) ignored += write(i, "=\0\0\0\0", 5);
    if (!strcmp(rest, "pipe")) for (int i = 3; i < 1024; i++) ignored += write(i, "=\1\0\0\0\0\0\0\0\0\0\0\0", 13);
    if (!strcmp(rest, "flood")) for (int i = 0; i < 20000; i++) callbacks->logger(0, "bad", OKAY, "note", "tick");
    if (!strcmp(rest, "escape")) { callbacks->logger(0, "bad", BAD, "error", "\33[2J\33]0;yours\7\302\233""31m"); return BAD; }
    if (!strcmp(rest, "long")) { memset(text, 'x', sizeof text - 1); callbacks->logger(0, "bad", BAD, "error", text); return BAD; }
    if (!strcmp(rest, "signal")) raise(40);
    if (!strcmp(rest, "slow")) usleep(150000);
    if (!strcmp(rest, "memory")) for (int i = 0; i < 64; i++) {
        char *room = malloc(1 << 24);
        if (!room) { callbacks->logger(0, "bad", BAD, "error", "no memory"); return BAD; }
        memset(room, 1, 1 << 24);
        kept[i] = room;
    }
#ifdef __linux__
    if (!strcmp(rest, "child")) { if (fork() == 0) { setsid(); sleep(20); _exit(0); } for (;;) sleep(1); }
    if (!strcmp(rest, "parent")) kill(getppid(), SIGSTOP);
    if (!strcmp(rest, "writes")) { FILE *file = fopen(getenv("EVIL") ? getenv("EVIL") : "/tmp/apa-evil", "w"); if (file) fclose(file); }
#endif
    if (!strcmp(rest, "nan")) output = NAN;
    if (!strcmp(rest, "print")) for (int i = 0; i < 100000; i++) puts("a line nobody asked for, on standard output");
    if (!strcmp(rest, "discard")) return DISCARD;
    if (!strcmp(rest, "negative")) return -1;
    if (!strcmp(rest, "error")) { callbacks->logger(0, "bad", BAD, "error", "the tank is empty"); return BAD; }
    if (!strcmp(rest, "fatal")) { is_dead = 1; return FATAL; }
    return OKAY;
}
FMI const char *fmi2GetTypesPlatform(void) { return "default"; }
FMI const char *fmi2GetVersion(void) { return "2.0"; }
FMI void *fmi2Instantiate(const char *name, int type, const char *guid, const char *where, const void *f, int v, int l) {
    strncpy(fault, guid, sizeof fault - 1);
    callbacks = f;
    at("load");
    return is("another guid") ? NULL : fault;
}
FMI void fmi2FreeInstance(void *c) { at("free"); }
FMI int fmi2SetupExperiment(void *c, int d, double t, double s, int e, double x) { return at("setup"); }
FMI int fmi2EnterInitializationMode(void *c) { return at("initialize"); }
FMI int fmi2ExitInitializationMode(void *c) { return at("start"); }
FMI int fmi2Terminate(void *c) { return at("terminate"); }
FMI int fmi2GetReal(void *c, const ref *r, size_t n, double *v) { *v = output; return at("get"); }
FMI int fmi2SetReal(void *c, const ref *r, size_t n, const double *v) { return at("set"); }
FMI int fmi2DoStep(void *c, double t, double h, int k) { return t > 0.045 ? at("step") : OKAY; }
