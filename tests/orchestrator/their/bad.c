/* An FMU of FMI 2.0 and 3.0 that does what its GUID says: crashes, hangs, leaves, refuses, at a place of its own. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <signal.h>
#include <unistd.h>
#ifdef __linux__
#include <fcntl.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#endif
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
static void (*log3)(void *, int, const char *, const char *);
static double flags[4];

static void note(int status, const char *words) {
    if (log3) log3(0, status, "note", words);
    else callbacks->logger(0, "bad", status, "note", words);
}
#ifdef __linux__
static void *notes(void *argument) {
    char line[3000];
    memset(line, 1, sizeof line - 1);
    line[sizeof line - 1] = 0;
    for (int i = 0; i < 3; i++) note(OKAY, line);
    return argument;
}
static void *later(void *argument) { for (;;) { usleep(1000); note(OKAY, "from a thread"); } return argument; }
static void *failing(void *argument) { usleep(20000); *(volatile int *)0 = 1; return argument; }
#endif

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
    if (!strcmp(rest, "flood")) for (int i = 0; i < 20000; i++) note(OKAY, "tick");
    if (!strcmp(rest, "escape")) { note(BAD, "\33[2J\33]0;yours\7\302\233""31m"); return BAD; }
    if (!strcmp(rest, "long")) { memset(text, 'x', sizeof text - 1); note(BAD, text); return BAD; }
    if (!strcmp(rest, "signal")) raise(40);
    if (!strcmp(rest, "slow")) usleep(150000);
    if (!strcmp(rest, "memory")) for (int i = 0; i < 64; i++) {
        char *room = malloc(1 << 24);
        if (!room) { note(BAD, "no memory"); return BAD; }
        memset(room, 1, 1 << 24);
        kept[i] = room;
    }
#ifdef __linux__
    if (!strcmp(rest, "child")) { if (fork() == 0) { setsid(); sleep(20); _exit(0); } for (;;) sleep(1); }
    if (!strcmp(rest, "parent")) kill(getppid(), SIGSTOP);
    if (!strcmp(rest, "writes")) { FILE *file = fopen(getenv("EVIL") ? getenv("EVIL") : "/tmp/apa-evil", "w"); if (file) fclose(file); }
#endif
    if (!strcmp(rest, "quit")) _exit(3);
    if (!strcmp(rest, "null")) { note(OKAY, NULL); if (!log3) callbacks->logger(0, NULL, OKAY, NULL, NULL); }
    if (!strcmp(rest, "bytes")) { note(BAD, "\377\376 \355\240\200 {when} {0} %s%n%d\npass  another\n\r \342\200\256"); return BAD; }
    if (!strcmp(rest, "levels")) for (int i = 0; i < 6; i++) note((int[]){-1, 5, 99, -2147483647 - 1, 2147483647, 4}[i], "an odd level");
    if (!strcmp(rest, "empty")) { note(BAD, ""); return BAD; }
    if (!strcmp(rest, "pending")) return 5;
    if (!strcmp(rest, "large")) return 2147483647;
    if (!strcmp(rest, "warning")) return WARNING;
    if (!strcmp(rest, "inf")) output = INFINITY;
    if (!strcmp(rest, "huge")) output = -1e308;
    if (!strcmp(rest, "tiny")) output = 5e-324;
    if (!strcmp(rest, "flags")) { flags[0] = flags[1] = flags[2] = 1.0; flags[3] = NAN; }
    if (!strcmp(rest, "spew")) for (int i = 0; i < 4096; i++) ignored += fwrite(text, 1, 1 << 16, stderr);
#ifdef __linux__
    if (!strcmp(rest, "deaf")) { for (int i = 1; i < 32; i++) signal(i, SIG_IGN); for (;;) sleep(1); }
    if (!strcmp(rest, "stop")) kill(getpid(), SIGSTOP);
    if (!strcmp(rest, "term")) { kill(getpid(), SIGTERM); sleep(1); }
    if (!strcmp(rest, "alarm")) { alarm(1); sleep(2); }
    if (!strcmp(rest, "deny")) { struct rlimit none = {0, 0}; setrlimit(RLIMIT_NOFILE, &none); }
    if (!strcmp(rest, "exec")) execl("/bin/sleep", "sleep", "20", (char *)0);
    if (!strcmp(rest, "away")) { ignored += chdir("/"); close(0); close(1); close(2); }
    if (!strcmp(rest, "devices")) { int n = open("/dev/zero", O_RDWR); for (int i = 3; i < 1024; i++) if (i != n) dup2(n, i); }
    if (!strcmp(rest, "twin")) fork();
    if (!strcmp(rest, "truncate")) { ignored += truncate("../../../shared", 0); for (int i = 3; i < 1024; i++) ignored += ftruncate(i, 0); }
    if (!strcmp(rest, "unlink")) { unlink("../../../shared"); unlink("../../../printed"); unlink("../../modelDescription.xml"); }
    if (!strcmp(rest, "swap")) { unlink("../../../printed"); ignored += symlink("/dev/zero", "../../../printed"); abort(); }
    if (!strcmp(rest, "pipefile")) { unlink("../../../printed"); ignored += mkfifo("../../../printed", 0600); abort(); }
    if (!strcmp(rest, "tree")) { char name[20]; for (int i = 0; i < 300; i++) { sprintf(name, "d%d", i); mkdir(name, 0); ignored += chdir(name) + mkdir("x", 0); chmod(".", 0); } }
    if (!strcmp(rest, "threads")) { pthread_t t[3]; for (int i = 0; i < 3; i++) pthread_create(t + i, 0, notes, 0); for (int i = 0; i < 3; i++) pthread_join(t[i], 0); }
    if (!strcmp(rest, "thread")) { pthread_t t; pthread_create(&t, 0, later, 0); usleep(20000); }
    if (!strcmp(rest, "thread crash")) { pthread_t t; pthread_create(&t, 0, failing, 0); usleep(50000); }
#endif
    if (!strcmp(rest, "nan")) output = NAN;
    if (!strcmp(rest, "print")) for (int i = 0; i < 20000; i++) puts("a line nobody asked for, on standard output");
    if (!strcmp(rest, "discard")) return DISCARD;
    if (!strcmp(rest, "negative")) return -1;
    if (!strcmp(rest, "error")) { note(BAD, "the tank is empty"); return BAD; }
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

typedef unsigned char bit;
typedef void (*Logger3)(void *, int, const char *, const char *);
FMI const char *fmi3GetVersion(void) { return "3.0"; }
FMI void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *where, bit v, bit l, bit e, bit r,
                                      const ref *required, size_t n, void *environment, Logger3 logger, void *update) {
    strncpy(fault, token, sizeof fault - 1);
    log3 = logger;
    at("load");
    return is("another guid") ? NULL : fault;
}
FMI void fmi3FreeInstance(void *c) { at("free"); }
FMI int fmi3EnterInitializationMode(void *c, bit d, double tolerance, double t, bit s, double e) { int status = at("setup"); return status ? status : at("initialize"); }
FMI int fmi3ExitInitializationMode(void *c) { return at("start"); }
FMI int fmi3Terminate(void *c) { return at("terminate"); }
FMI int fmi3GetFloat64(void *c, const ref *r, size_t n, double *v, size_t m) { for (size_t i = 0; i < m; i++) v[i] = output; return at("get"); }
FMI int fmi3SetFloat64(void *c, const ref *r, size_t n, const double *v, size_t m) { return at("set"); }
FMI int fmi3DoStep(void *c, double t, double h, bit keep, bit *event, bit *end, bit *early, double *last) {
    int status = t > 0.045 ? at("step") : OKAY;
    *event = flags[0] > 0; *end = flags[1] > 0; *early = flags[2] > 0; *last = flags[3];
    return status;
}
