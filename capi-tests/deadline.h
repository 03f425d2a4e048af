/* A call that hangs is a failure too: the process ends after a time limit. C99 and C++11. */
#ifndef CAPI_TESTS_DEADLINE_H
#define CAPI_TESTS_DEADLINE_H

#ifdef _WIN32

#include "small_windows.h"

#include <stdio.h>

static DWORD WINAPI deadline_wait(LPVOID seconds)
{
    Sleep(1000 * *(unsigned int *)seconds);
    fprintf(stderr, "time limit exceeded\n");
    TerminateProcess(GetCurrentProcess(), 124);
    return 0;
}

static inline void deadline(unsigned int seconds)
{
    static unsigned int kept;
    HANDLE thread;
    kept = seconds;
    thread = CreateThread(NULL, 0, deadline_wait, &kept, 0, NULL);
    if (thread == NULL) {
        fprintf(stderr, "cannot start the deadline thread\n");
        TerminateProcess(GetCurrentProcess(), 1);
    }
    CloseHandle(thread);
}

#else

#include <unistd.h>

static inline void deadline(unsigned int seconds)
{
    alarm(seconds);
}

#endif

#endif
