/* Makes the n-th call of one kind on files under given folders fail, once: APA_FAIL_CALL, APA_FAIL_AT, APA_FAIL_UNDER.
 * A fork counts wherever it is made. The file APA_FAIL_MARK says that the call was reached. */

#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

static atomic_int made;

static bool is_under(const char *path) {
    const char *under = getenv("APA_FAIL_UNDER");
    return path && under && !strncmp(path, under, strlen(under));
}

static bool is_file_under(int file) {
    char link[64], path[4096];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t size = readlink(link, path, sizeof path - 1);
    if (size < 0) return false;
    path[size] = 0;
    return is_under(path);
}

static bool fails(const char *call) {
    const char *chosen = getenv("APA_FAIL_CALL"), *at = getenv("APA_FAIL_AT"), *mark = getenv("APA_FAIL_MARK");
    if (!chosen || !at || !mark || strcmp(chosen, call) || atomic_fetch_add(&made, 1) + 1 != atoi(at)) return false;
    const long file = syscall(SYS_openat, AT_FDCWD, mark, O_CREAT | O_WRONLY, 0600);
    if (file >= 0) syscall(SYS_close, file);
    return true;
}

static int opened(const char *path, int flags, mode_t mode, int folder) {
    if (is_under(path) && fails("open")) {
        errno = EMFILE;
        return -1;
    }
    return (int)syscall(SYS_openat, folder, path, flags, mode);
}

#define OPENS(name, ...)                  \
    int name(__VA_ARGS__, ...) {          \
        va_list more;                     \
        va_start(more, flags);            \
        const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) ? va_arg(more, mode_t) : 0; \
        va_end(more);

OPENS(open, const char *path, int flags) return opened(path, flags, mode, AT_FDCWD); }
OPENS(open64, const char *path, int flags) return opened(path, flags, mode, AT_FDCWD); }
OPENS(openat, int folder, const char *path, int flags) return opened(path, flags, mode, folder); }
OPENS(openat64, int folder, const char *path, int flags) return opened(path, flags, mode, folder); }

ssize_t write(int file, const void *data, size_t size) {
    if (is_file_under(file) && fails("write")) {
        errno = ENOSPC;
        return -1;
    }
    return syscall(SYS_write, file, data, size);
}

static void *mapped(void *at, size_t size, int access, int flags, int file, off_t offset) {
    if (file >= 0 && is_file_under(file) && fails("mmap")) {
        errno = ENOMEM;
        return MAP_FAILED;
    }
    return (void *)syscall(SYS_mmap, at, size, access, flags, file, offset);
}

void *mmap(void *at, size_t size, int access, int flags, int file, off_t offset) {
    return mapped(at, size, access, flags, file, offset);
}

void *mmap64(void *at, size_t size, int access, int flags, int file, off_t offset) {
    return mapped(at, size, access, flags, file, offset);
}

pid_t fork(void) {
    if (fails("fork")) {
        errno = EAGAIN;
        return -1;
    }
    pid_t (*next)(void) = (pid_t(*)(void))dlsym(RTLD_NEXT, "fork");
    return next();
}

pid_t vfork(void) { return fork(); }
