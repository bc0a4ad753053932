/* live.c as a program: numbers from standard input, the trace to standard output. Statically linked, it has the
 * mathematics library that the module of the page has. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct Live Live;
double *live_numbers(int32_t count);
Live *live_open(const double *number);
double *live_row(Live *live);
int32_t live_run(Live *live, const double *params, const double *times, const double *faults, double *trace,
                 int32_t every, int32_t room);

static double *take(void) {
    double count = 0.0;
    double *found;
    if (fread(&count, sizeof count, 1, stdin) != 1) exit(1);
    found = live_numbers((int32_t)count);
    if (fread(found, sizeof(double), (size_t)count, stdin) != (size_t)count) exit(1);
    return found;
}

int main(void) {
    Live *live = live_open(take());
    const double *params = take(), *times = take(), *faults = take(), *sizes = take();
    const int32_t room = (int32_t)sizes[0], width = (int32_t)sizes[1];
    double *trace = live_numbers(room * width);
    const int32_t lines = live_run(live, params, times, faults, trace, 1, room);
    fwrite(live_row(live), sizeof(double), 2, stdout);
    fwrite(trace, sizeof(double), (size_t)(lines * width), stdout);
    return 0;
}
