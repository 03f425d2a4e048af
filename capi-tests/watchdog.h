/* Ends a test program that hangs. C++11. */
#ifndef CAPI_TESTS_WATCHDOG_H
#define CAPI_TESTS_WATCHDOG_H

#include <stdio.h>
#include <stdlib.h>

#include <chrono>
#include <thread>

static inline void watchdog(int seconds)
{
    std::thread([seconds] {
        std::this_thread::sleep_for(std::chrono::seconds(seconds));
        fprintf(stderr, "still running after %d seconds\n", seconds);
        abort();
    }).detach();
}

#endif
