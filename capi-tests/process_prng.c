/* bcryptprimitives.dll with the one function that Rust's standard library imports from it, for versions of wine that lack the
 * DLL. Only .ci/windows builds it; Windows has its own. */
#include <windows.h>
#include <ntsecapi.h>

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE data, SIZE_T size)
{
    while (size > 0) {
        const ULONG part = size < 0x10000000 ? (ULONG)size : 0x10000000;
        /* RtlGenRandom, exported by advapi32 as SystemFunction036. */
        if (!RtlGenRandom(data, part))
            return FALSE;
        data += part;
        size -= part;
    }
    return TRUE;
}
