/*
 * CPU occlusion culling on a masked hierarchical depth buffer: the instruction sets, for MaskedOcclusionCulling.h, which
 * includes this file.
 *
 * Programs that were written before there were SCALAR, NEON and SIMD128 name the other four in a switch, and compile with -Wswitch
 * -Werror; programs that name all of them do, too. So SCALAR, NEON and SIMD128 have enumerators that compilers do not miss in a switch:
 * GCC from 11 on those with a reserved name from a system header, which is why this is a file of its own, and Clang those that may be
 * unused. An older GCC has no such enumerators; it warns of the case of a value without one. MSVC does not warn at all, unless
 * C4062 is switched on: then of a switch over four.
 *
 * SPDX-License-Identifier: Apache-2.0 OR MIT
 */
#pragma once

#if defined(__GNUC__)
#pragma GCC system_header
#endif

#if defined(__clang__)
#define MOC_DETAIL_QUIET_ENUMERATORS 1
#define MOC_DETAIL_QUIET __attribute__((unused))
#elif !defined(__GNUC__)
#define MOC_DETAIL_QUIET_ENUMERATORS 1
#define MOC_DETAIL_QUIET
#elif __GNUC__ >= 11
#define MOC_DETAIL_QUIET_ENUMERATORS 1
#define MOC_DETAIL_QUIET __attribute__((unused))
#else
#define MOC_DETAIL_QUIET_ENUMERATORS 0
#endif

/* Also where a program includes its headers inside of extern "C", which templates must not be in. */
#include "moc_names.h"

extern "C++" {

MOC_NAMESPACE_BEGIN

/* The members of the class. The template is for the definitions of the constants, which C++11 wants in one place. */
template <class Unused> struct MOC_DetailImplementations
{
    /** An instruction set. All of them give the same bits. */
    enum Implementation : int
    {
        SSE2   = MOC_SSE2,
        SSE41  = MOC_SSE41,
        AVX2   = MOC_AVX2,
        AVX512 = MOC_AVX512,
#if MOC_DETAIL_QUIET_ENUMERATORS
        _MOC_SCALAR MOC_DETAIL_QUIET = MOC_SCALAR,
        _MOC_NEON MOC_DETAIL_QUIET = MOC_NEON,
        _MOC_SIMD128 MOC_DETAIL_QUIET = MOC_SIMD128
#endif
    };
    static constexpr Implementation SCALAR  = static_cast<Implementation>(MOC_SCALAR);
    static constexpr Implementation NEON    = static_cast<Implementation>(MOC_NEON);
    static constexpr Implementation SIMD128 = static_cast<Implementation>(MOC_SIMD128);
};

#if __cplusplus < 201703L
template <class Unused>
constexpr typename MOC_DetailImplementations<Unused>::Implementation MOC_DetailImplementations<Unused>::SCALAR;
template <class Unused>
constexpr typename MOC_DetailImplementations<Unused>::Implementation MOC_DetailImplementations<Unused>::NEON;
template <class Unused>
constexpr typename MOC_DetailImplementations<Unused>::Implementation MOC_DetailImplementations<Unused>::SIMD128;
#endif

MOC_NAMESPACE_END

} /* extern "C++" */

#include "moc_names_end.h"
