/*
 * Two copies of the library in one program, one without a prefix and one with acme_: each is used in C and in C++, by files
 * that are compiled once per copy. Linked with --wrap for the functions below, so that calls are counted per copy. The
 * arguments are the files in which the two copies should be found.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* What the files expect on the screen after drawing a wall over its left (-1) or right half. Each returns 0, or the line of the
 * failed check. */
int plain_in_c(float side), acme_in_c(float side);
int plain_in_cpp(float side), acme_in_cpp(float side);

enum { CLEAR, TEST, FLUSH, LOAD, FUNCTIONS };
static const char *const names[] = {"ClearBuffer", "TestRect", "ThreadpoolFlush", "RecordingLoad"};
static int plain_calls[FUNCTIONS], acme_calls[FUNCTIONS];

#define COUNT(calls, function, n, parameters, arguments)    \
    int32_t __real_##function parameters;                   \
    int32_t __wrap_##function parameters;                   \
    int32_t __wrap_##function parameters                    \
    {                                                       \
        ++calls[n];                                         \
        return __real_##function arguments;                 \
    }
#define COUNT_BOTH(function, n, parameters, arguments)                \
    COUNT(plain_calls, MOC_##function, n, parameters, arguments)      \
    COUNT(acme_calls, acme_MOC_##function, n, parameters, arguments)

COUNT_BOTH(ClearBuffer, CLEAR, (void *moc), (moc))
COUNT_BOTH(TestRect, TEST, (const void *moc, float x0, float y0, float x1, float y1, float w, int32_t *result),
           (moc, x0, y0, x1, y1, w, result))
COUNT_BOTH(ThreadpoolFlush, FLUSH, (const void *pool), (pool))
COUNT_BOTH(RecordingLoad, LOAD, (const char *path, void **out), (path, out))

static int failures;

/* Runs one file and compares how often each function was called. */
static void run(const char *what, int (*file)(float), float side, int plain, int acme, int in_cpp)
{
    static const int calls[2][FUNCTIONS] = {{1, 2, 0, 0}, {1, 3, 1, 1}};
    int n, line;
    memset(plain_calls, 0, sizeof plain_calls);
    memset(acme_calls, 0, sizeof acme_calls);
    line = file(side);
    if (line != 0)
    {
        fprintf(stderr, "%s: line %d\n", what, line);
        ++failures;
    }
    for (n = 0; n < FUNCTIONS; ++n)
    {
        if (plain_calls[n] == plain * calls[in_cpp][n] && acme_calls[n] == acme * calls[in_cpp][n])
            continue;
        fprintf(stderr, "%s: %d calls of MOC_%s, %d of acme_MOC_%s\n", what, plain_calls[n], names[n], acme_calls[n],
                names[n]);
        ++failures;
    }
}

static void lies_in(void *function, const char *file)
{
    Dl_info info;
    const char *found;
    found = dladdr(function, &info) ? info.dli_fname : "no file";
    found = strrchr(found, '/') ? strrchr(found, '/') + 1 : found;
    if (strncmp(found, file, strlen(file)) != 0)
    {
        fprintf(stderr, "a function is in %s, not in %s\n", found, file);
        ++failures;
    }
}

int main(int argc, char **argv)
{
    if (argc != 3)
        return 2;
    lies_in((void *)(uintptr_t)&__real_MOC_TestRect, argv[1]);
    lies_in((void *)(uintptr_t)&__real_acme_MOC_TestRect, argv[2]);
    run("C, no prefix", plain_in_c, -1, 1, 0, 0);
    run("C, acme_", acme_in_c, 1, 0, 1, 0);
    run("C++, no prefix", plain_in_cpp, -1, 1, 0, 1);
    run("C++, acme_", acme_in_cpp, 1, 0, 1, 1);
    return failures != 0;
}
