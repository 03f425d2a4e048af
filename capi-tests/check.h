/* Shared by the test programs: checks that report what failed, and a few meshes. C99 and C++11. */
#ifndef CAPI_TESTS_CHECK_H
#define CAPI_TESTS_CHECK_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int check_failures = 0;

/* Counts and prints a condition that does not hold; the program continues. */
#define CHECK(condition)                                                                  \
    do {                                                                                  \
        if (!(condition)) {                                                               \
            fprintf(stderr, "%s:%d: failed: %s\n", __FILE__, __LINE__, #condition);       \
            check_failures++;                                                             \
        }                                                                                 \
    } while (0)

/* As CHECK for two integers, with both values. */
#define CHECK_EQ(is, should)                                                              \
    do {                                                                                  \
        const long long is_ = (long long)(is), should_ = (long long)(should);             \
        if (is_ != should_) {                                                             \
            fprintf(stderr, "%s:%d: failed: %s is %lld, not %lld (%s)\n", __FILE__,       \
                    __LINE__, #is, is_, should_, #should);                                \
            check_failures++;                                                             \
        }                                                                                 \
    } while (0)

/* The instruction set that MOC_SCALAR stands for: on these processors scalar code is not compiled. */
#if defined(__x86_64__) || defined(__i386__) || defined(_M_X64) || defined(_M_IX86)
#define SIMPLEST_IMPLEMENTATION MOC_SSE2
#elif defined(__aarch64__) || defined(_M_ARM64)
#define SIMPLEST_IMPLEMENTATION MOC_NEON
#else
#define SIMPLEST_IMPLEMENTATION MOC_SCALAR
#endif

/* The program's exit code. */
static inline int check_report(const char *program)
{
    if (check_failures != 0)
        fprintf(stderr, "%s: %d checks failed\n", program, check_failures);
    return check_failures != 0;
}

/* Two triangles, counter-clockwise with y up. */
static const uint32_t QUAD[6] = {0, 1, 2, 0, 2, 3};

/* A rectangle in normalised device coordinates at distance w, as clip-space x, y, z, w. */
static inline void quad_at(float *out16, float xmin, float ymin, float xmax, float ymax, float w)
{
    const float corners[4][2] = {{xmin, ymin}, {xmax, ymin}, {xmax, ymax}, {xmin, ymax}};
    int i;
    for (i = 0; i < 4; i++) {
        out16[4 * i + 0] = corners[i][0] * w;
        out16[4 * i + 1] = corners[i][1] * w;
        out16[4 * i + 2] = 0.0f;
        out16[4 * i + 3] = w;
    }
}

/* A reproducible sequence of numbers. */
static inline uint32_t next_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

/* From -1 to 1. */
static inline float next_unit(uint32_t *state)
{
    return (float)next_random(state) / 8388608.0f - 1.0f;
}

/* Fills n triangles of different sizes, all around the view and beyond it: 12 floats and 3 indices each. */
static inline void random_triangles(float *vertices, uint32_t *indices, int n, uint32_t seed)
{
    int t, v;
    for (t = 0; t < n; t++) {
        const float w = 5.0f + 4.0f * next_unit(&seed);
        const float x = 1.3f * next_unit(&seed), y = 1.3f * next_unit(&seed);
        const float size = t % 7 == 0 ? 1.0f : 0.15f;
        for (v = 0; v < 3; v++) {
            float *out = vertices + 12 * t + 4 * v;
            const float vertex_w = w + 0.5f * next_unit(&seed);
            out[0] = (x + size * next_unit(&seed)) * vertex_w;
            out[1] = (y + size * next_unit(&seed)) * vertex_w;
            out[2] = 0.0f;
            out[3] = vertex_w;
            indices[3 * t + v] = (uint32_t)(3 * t + v);
        }
    }
}

#endif
