/*
 * CPU occlusion culling on a masked hierarchical depth buffer: the instruction sets, for MaskedOcclusionCulling.h, which
 * includes this file.
 *
 * A switch over the four instruction sets that existed before SCALAR, NEON and SIMD128 must compile with -Wswitch -Werror, and
 * so must one over all of them. So SCALAR, NEON and SIMD128 have enumerators whose absence from a switch compilers do not
 * report: GCC from 11 on exempts reserved names from a system header, which is why this is a separate file, and Clang exempts
 * enumerators marked unused. For older versions of GCC there are no such enumerators; they warn about a case whose value has
 * none. MSVC does not warn at all unless C4062 is enabled: then it warns about a switch over four.
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

/* For programs that include this header inside extern "C", where templates are not allowed. */
#include "moc_names.h"

extern "C++" {

MOC_NAMESPACE_BEGIN

/* The members of the class. A template, so that a header can define the constants in C++11. */
template <class Unused> struct MOC_DetailImplementations
{
    /** An instruction set. All of them give bit-identical results. */
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
    /** The simplest instruction set of the target (SSE2, NEON or simd128), unless the library was built with the feature
     * `scalar` or the target has none: then plain code. */
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
