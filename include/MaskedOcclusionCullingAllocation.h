/*
 * CPU occlusion culling on a masked hierarchical depth buffer: exceptions thrown by allocation callbacks, for the C++ headers
 * and the files in link/, which include this file.
 *
 * No exception may pass through the library, so an exception from a callback is caught before it gets there, the library is
 * told that there is no memory, and the exception is rethrown once the C function has returned. The object is then as it was
 * before the call. When the callback is called on behalf of anything else, such as a C function that the program calls itself,
 * or a method compiled into another shared library, an exception just counts as out of memory. Without exceptions none of this
 * is compiled.
 *
 * SPDX-License-Identifier: Apache-2.0 OR MIT
 */
#pragma once

#if defined(MOC_DETAIL_EXCEPTIONS)
/* A test overrides the compiler's setting. */
#elif defined(__cpp_exceptions) || defined(__EXCEPTIONS) || defined(_CPPUNWIND)
#define MOC_DETAIL_EXCEPTIONS 1
#else
#define MOC_DETAIL_EXCEPTIONS 0
#endif

/* For functions whose code differs between units with and without exceptions: each unit gets its own copy. */
#if defined(_MSC_VER)
#define MOC_DETAIL_INLINE __forceinline
#elif defined(__GNUC__)
#define MOC_DETAIL_INLINE inline __attribute__((always_inline))
#else
#define MOC_DETAIL_INLINE inline
#endif

/* For programs that include this header inside extern "C". */
extern "C++" {

#include <stddef.h>

#if MOC_DETAIL_EXCEPTIONS
#include <exception>
#endif

#include "masked_occlusion_culling.h"

#include "moc_names.h"

MOC_NAMESPACE_BEGIN

/* Put before a C function that may allocate; ThrowAgain after it. */
template <bool Exceptions> class MOC_DetailAllocation
{
public:
    MOC_DetailAllocation() {}
    /* For MOC_Settings::call_alloc. */
    static MOC_CallAlloc Caller() { return nullptr; }
    static void *Call(MOC_AlignedAlloc alloc, size_t alignment, size_t size) { return alloc(alignment, size); }
    void ThrowAgain() {}
    MOC_DetailAllocation(const MOC_DetailAllocation &) = delete;
    MOC_DetailAllocation &operator=(const MOC_DetailAllocation &) = delete;
};

#if MOC_DETAIL_EXCEPTIONS
template <> class MOC_DetailAllocation<true>
{
public:
    MOC_DetailAllocation() : mOuter(Innermost()) { Innermost() = this; }
    ~MOC_DetailAllocation() { Innermost() = mOuter; }

    static MOC_CallAlloc Caller() { return &Call; }

    static void *Call(MOC_AlignedAlloc alloc, size_t alignment, size_t size)
    {
        /* Library calls made by the callback itself are not part of this call. */
        MOC_DetailAllocation *const innermost = Innermost();
        Innermost() = nullptr;
        void *memory = nullptr;
        try
        {
            memory = alloc(alignment, size);
        }
        catch (...)
        {
            if (innermost != nullptr)
                innermost->mThrown = std::current_exception();
        }
        Innermost() = innermost;
        return memory;
    }

    void ThrowAgain()
    {
        if (mThrown)
            std::rethrow_exception(mThrown);
    }

    MOC_DetailAllocation(const MOC_DetailAllocation &) = delete;
    MOC_DetailAllocation &operator=(const MOC_DetailAllocation &) = delete;

private:
    static MOC_DetailAllocation *&Innermost()
    {
        static thread_local MOC_DetailAllocation *innermost = nullptr;
        return innermost;
    }

    MOC_DetailAllocation *mOuter;
    std::exception_ptr mThrown;
};
#endif

MOC_NAMESPACE_END

} /* extern "C++" */

#include "moc_names_end.h"
