/* What both host programs have: the library, its functions by name, and a thread with little stack.
 *
 * With HOST_STACK defined [bytes], everything runs in a thread that has no more stack than that.
 */
#ifndef HOST_H
#define HOST_H

#ifdef _WIN32
#include <windows.h>
#define dlopen(path, flags) ((void *)LoadLibraryA(path))
#define dlsym(handle, name) ((void *)GetProcAddress((HMODULE)(handle), name))
#define dlerror() "the library cannot be loaded"
#else
#include <dlfcn.h>
#endif
#ifdef HOST_STACK
#include <pthread.h>
#endif
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_FUNCTIONS = 128 };
static void *library;
static const char *functions[MOST_FUNCTIONS];
static int function_count;

/* Return a function of the library, and note that it was called. */
static void *find(const char *name) {
    void *found = dlsym(library, name);
    int k = 0;
    if (!found) {
        fprintf(stderr, "no %s\n", name);
        exit(2);
    }
    while (k < function_count && functions[k] != name && strcmp(functions[k], name)) k++;
    if (k == function_count && k < MOST_FUNCTIONS) functions[function_count++] = name;
    return found;
}

#define CALL(name) ((__typeof__(&name))find(#name))

typedef struct {
    int (*main)(int, char **);
    int count;
    char **words;
    int result;
} Task;

static void *work(void *data) {
    Task *task = data;
    task->result = task->main(task->count, task->words);
    return NULL;
}

/* Return what `own_main` returns, run in a thread with little stack if HOST_STACK is defined. */
static int in_thread(int (*own_main)(int, char **), int count, char **words) {
    Task task = {own_main, count, words, 9};
#ifdef HOST_STACK
    pthread_attr_t attributes;
    pthread_t thread;
    if (pthread_attr_init(&attributes) || pthread_attr_setstacksize(&attributes, HOST_STACK) ||
        pthread_create(&thread, &attributes, work, &task) || pthread_join(thread, NULL))
        return 9;
#else
    work(&task);
#endif
    return task.result;
}

#endif
