/* windows.h without its rarely used parts, and without macros that clash with other names. */
#ifndef CAPI_TESTS_SMALL_WINDOWS_H
#define CAPI_TESTS_SMALL_WINDOWS_H

#ifndef WIN32_LEAN_AND_MEAN
#define WIN32_LEAN_AND_MEAN
#endif
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>
#undef near
#undef far

#endif
