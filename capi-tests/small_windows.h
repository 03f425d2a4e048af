/* windows.h without what programs seldom need, and without min and max, which are names of C++. */
#ifndef CAPI_TESTS_SMALL_WINDOWS_H
#define CAPI_TESTS_SMALL_WINDOWS_H

#ifndef WIN32_LEAN_AND_MEAN
#define WIN32_LEAN_AND_MEAN
#endif
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>

#endif
