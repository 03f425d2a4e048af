/*
 * CPU occlusion culling on a masked hierarchical depth buffer: the C interface.
 *
 * Draw a few large occluders into a small depth buffer, then ask for each object whether any of it could be
 * seen. "Occluded" is certain; "visible" means that it may be seen.
 *
 * A frame
 *
 *     #include "masked_occlusion_culling.h"
 *     #include <stdio.h>
 *
 *     int main(void)
 *     {
 *         // Once: an object, its buffer, and the camera's near plane.
 *         MaskedOcclusionCulling *moc;
 *         if (MOC_Create(NULL, &moc) != MOC_STATUS_OK || MOC_SetResolution(moc, 640, 360) != MOC_STATUS_OK)
 *             return 1;
 *         MOC_SetNearClipPlane(moc, 0.1f);
 *
 *         // Each frame: clear, draw occluders, test occludees. A wall at distance 10, as x, y, z, w in clip space.
 *         const float wall[] = {-5, -5, 0, 10, 5, -5, 0, 10, 5, 5, 0, 10, -5, 5, 0, 10};
 *         const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
 *         MOC_ClearBuffer(moc);
 *         MOC_RenderTriangles(moc, wall, triangles, 2, NULL, MOC_BACKFACE_CW, MOC_CLIP_PLANE_ALL, NULL, NULL);
 *
 *         // An object whose screen rectangle is a fifth of the screen's width and height, and whose nearest point is at 12.
 *         int32_t result;
 *         MOC_TestRect(moc, -0.2f, -0.2f, 0.2f, 0.2f, 12, &result);
 *         puts(result == MOC_VISIBLE ? "draw it" : "hidden");
 *
 *         MOC_Destroy(moc);
 *         return 0;
 *     }
 *
 * Order of calls. Once: MOC_DefaultSettings if the defaults do not suit, MOC_Create, MOC_SetResolution,
 * MOC_SetNearClipPlane. Each frame: MOC_ClearBuffer, then draws and tests, in any order and as often as needed. A test
 * is answered from what has been drawn so far, so draw near and large occluders first. At the end:
 * MOC_ThreadpoolDestroy and MOC_Destroy.
 *
 * Units
 *   clip space   (x, y, w): x right, y up, w away from the eye and positive in view. z is not used. A point is on the
 *                screen if -w <= x <= w and -w <= y <= w.
 *   NDC          normalised device coordinates: x/w and y/w, the screen is -1 to 1, y up. For MOC_TestRect.
 *   w            near planes and `wmin` are distances in clip-space w, in the program's own unit of length.
 *   depth        1/w: 0 is infinitely far, larger is nearer. Negative where nothing was drawn.
 *   pixels       columns from the left, rows from the top, or from the bottom with MOC_Y_AXIS_UP. A draw covers the
 *                pixels whose centres are inside, with vertices rounded to 1/256 pixel and the top-left rule; a test
 *                covers every pixel that is touched.
 *   counts       `n_triangles` and `triangle_count` count triangles, `vertex_count` vertices, `vertex_floats` and
 *                `out_floats` floats; strides and offsets are in bytes.
 *
 * Ranges
 *   buffers      1 to 16384 pixels wide and high.
 *   w            2^-30 to 2^40. Nearer geometry is clipped. An occluder triangle with a corner that is farther is dropped;
 *                an occludee with one counts as visible.
 *   x, y         any finite number. An occluder triangle with a NaN or an infinity is dropped; an occludee with one is visible.
 *   triangles    0 to INT32_MAX per call; indices are unsigned 32-bit integers.
 *
 * Status. Every function returns a MOC_Status, except MOC_GetAbiVersion, MOC_StatusText and MOC_GetLastStatus. If it is
 * not MOC_STATUS_OK, nothing was drawn or changed, unless the function's documentation says otherwise, and a `result`
 * is MOC_VISIBLE: a program that ignores the status of draws and tests culls less, but nothing worse happens.
 * Enumerations are passed as int32_t and checked. MOC_GetLastStatus returns the status of the thread's last call, and
 * MOC_SetMessageCallback sets a function that receives which argument was refused and why.
 *
 * Null. A pointer may be null where the function's documentation says so; otherwise null is refused with
 * MOC_STATUS_NULL_POINTER. The library cannot check any other pointer: the paragraph "Required" of a function states
 * what must hold, and if it does not, the behaviour is undefined. Where that paragraph says "null or", null does no
 * harm; the text above it says whether null is refused. Indices are trusted, too, unless a MOC_Mesh gives the number of
 * vertices; functions whose names end in Checked take the length of the array and check every index.
 *
 * Features. A library built without the feature `pool` or `recorder` lacks the functions of the pool or of the recorder,
 * which shows when linking.
 *
 * Structs that may grow begin with their `size`, which the caller sets: MOC_Settings settings = {.size = sizeof
 * settings}. A program compiled with an older header passes a smaller size, and nothing beyond it is read or written. A
 * size smaller than that of the first version is refused with MOC_STATUS_INVALID_SIZE.
 *
 * Meshes. MOC_RenderMesh, MOC_TestMesh, MOC_BinMesh, MOC_RecordMesh and those of the pool take a MOC_Mesh.
 * MOC_RenderTriangles, MOC_TestTriangles, MOC_BinTriangles and MOC_RecordRenderTriangles take the same data as separate
 * arguments, like the methods of the C++ class.
 *
 * Ownership. The caller destroys what MOC_Create, MOC_ThreadpoolCreate, MOC_ThreadpoolCreateFrom, MOC_RecordingLoad and
 * MOC_RecordingFromMemory create. All other memory remains the caller's, is read or written only during the call, and
 * may be freed when the call returns, with three exceptions: the vertices and indices of calls submitted to a pool, and
 * the objects of MOC_ThreadpoolMergeBuffers, must stay unchanged until MOC_ThreadpoolFlush or another flushing call
 * returns (matrix and layout are copied); and the callbacks of MOC_Settings are called until the object is destroyed. A
 * pool and the object that it draws into may be destroyed in either order.
 *
 * Threads. Different objects are independent, and none is bound to the thread that created it. Functions that take a
 * const object may run on several threads at once, as long as no function runs that takes the object without const. One
 * of them draws: MOC_RenderTrilist, whose documentation states its requirements. A pool may be called from several
 * threads at once. While a pool draws into an object, any thread may query that object; calls that would change or copy
 * its buffer are refused (MOC_STATUS_BUSY) until MOC_Flush.
 *
 * Pitfalls
 *   floating point   A call rounds to nearest, keeps denormals and does not trap, whatever the thread's settings, and restores
 *                    them: the results are the same bits in any rounding mode, and there is no SIGFPE. It may leave exception
 *                    flags set (fetestexcept) if the thread has the default settings. On processors other than x86 with SSE and
 *                    aarch64 the settings are not changed: there, results are specified only for threads that round to nearest.
 *   stack            A draw or a test of triangles needs up to 59 KB of stack (64 KB in a build without optimisation),
 *                    MOC_BinTriangles 42 KB, MOC_RenderTrilist 33 KB, MOC_TestRect and most others less than 5 KB. Calls
 *                    that may draw what a pool still has in flight (MOC_ThreadpoolWorkOnce, MOC_ThreadpoolFlush, MOC_Flush,
 *                    MOC_Destroy and the like) need 42 KB. 64 KB is too small for draws and triangle tests once a fiber's own
 *                    frames are counted: give fibers 96 KB or more.
 *   transforming     MOC_TransformVertices does not work in place: it writes 16 bytes per vertex, and with a smaller input
 *                    stride it would overwrite vertices that it has not read yet.
 *   dlclose          May leave the library mapped: on Linux a thread that used a pool keeps it mapped until the thread ends,
 *                    the main thread forever. That is safe, but loading the same path again gives the old build.
 *   allocation       The callbacks of MOC_Settings must not throw; MOC_CallAlloc is for allocators that do.
 *
 * Further reading
 *   docs/conventions.md     matrices, vertex layouts, Direct3D, OpenGL, Vulkan, screen bounds of boxes, orthographic views
 *   docs/migrating.md       for programs that use Intel's MaskedOcclusionCulling
 *   docs/recordings.md      recorded frames
 *   cpp-examples/           programs in C and C++
 *   moc_names.h             a prefix for the function names, in case they collide with others
 *   MaskedOcclusionCulling.h, CullingThreadpool.h, FrameRecorder.h     the C++ interface
 *
 * Generated by cbindgen from src/capi: do not edit. SPDX-License-Identifier: Apache-2.0 OR MIT
 */

#ifndef MASKED_OCCLUSION_CULLING_C_H
#define MASKED_OCCLUSION_CULLING_C_H

#include <stddef.h>
#include <stdint.h>
#include "moc_names.h"

MOC_NAMESPACE_BEGIN

/**
 * An object that holds settings and a depth buffer; see MOC_Create. In C++ it is the class of
 * MaskedOcclusionCulling.h.
 */
#ifdef __cplusplus
class MaskedOcclusionCulling;
#else
typedef struct MaskedOcclusionCulling MaskedOcclusionCulling;
#endif

/**
 * The version of this interface: 1000 * major + minor of the library's version.
 *
 * Compare it with MOC_GetAbiVersion() to check that header and library belong together: before version 1.0 they must
 * be equal; from then on the major versions must be equal, and the library's minor version must be at least that of
 * the header.
 */
#define MOC_ABI_VERSION 2

/**
 * The `vertex_count` of a MOC_Mesh whose number of vertices is unknown: its indices are trusted.
 */
#define MOC_UNCHECKED 4294967295

/**
 * In recordings: the answer is not known.
 */
#define MOC_RESULT_UNKNOWN -1

/**
 * The result of a call. If it is not MOC_STATUS_OK, nothing was drawn, merged or changed, unless the function's
 * documentation says otherwise.
 */
enum MOC_Status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The call succeeded.
     */
    MOC_STATUS_OK = 0,
    /**
     * A required pointer is null.
     */
    MOC_STATUS_NULL_POINTER = 1,
    /**
     * An integer is not a value of the enumeration or flag that it is passed for.
     */
    MOC_STATUS_INVALID_ENUM = 2,
    /**
     * A width, height, bin count, triangle count, array length or rectangle is out of range.
     */
    MOC_STATUS_INVALID_SIZE = 3,
    /**
     * A number that must be finite is not.
     */
    MOC_STATUS_INVALID_NUMBER = 4,
    /**
     * A vertex layout has a negative stride or, if the length of the array is given, a negative offset; or a pointer
     * is misaligned (indices and floats to be written must be aligned to 4 bytes, lists to 8).
     */
    MOC_STATUS_INVALID_LAYOUT = 5,
    /**
     * The object has no buffer: call MOC_SetResolution first.
     */
    MOC_STATUS_NO_BUFFER = 6,
    /**
     * An index refers to a vertex that does not exist.
     */
    MOC_STATUS_INDEX_OUT_OF_RANGE = 7,
    /**
     * The two buffers differ in resolution or row direction.
     */
    MOC_STATUS_SIZE_MISMATCH = 8,
    /**
     * A triangle list was full. The triangles that fitted are in the lists.
     */
    MOC_STATUS_LIST_FULL = 9,
    /**
     * An allocation failed.
     */
    MOC_STATUS_OUT_OF_MEMORY = 10,
    /**
     * An internal error. Memory is intact, but the call did not finish.
     */
    MOC_STATUS_INTERNAL = 11,
    /**
     * The file of a recording cannot be created, written or read.
     */
    MOC_STATUS_FILE = 12,
    /**
     * A file is not a recording, or it is truncated or corrupt.
     */
    MOC_STATUS_INVALID_RECORDING = 13,
    /**
     * A pool has work in flight for the object: call MOC_Flush first. Or the object belongs to another pool, or
     * it is already recording.
     */
    MOC_STATUS_BUSY = 14,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum MOC_Status MOC_Status;
#else
typedef int32_t MOC_Status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * An instruction set that the library is compiled for. All of them give the same bits.
 */
enum MOC_Implementation
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Plain code without explicit vector instructions, for targets that have none. Elsewhere it is left out, and the
     * simplest instruction set takes its place.
     */
    MOC_SCALAR = -1,
    /**
     * SSE2, the baseline of x86-64 and i686.
     */
    MOC_SSE2 = 0,
    /**
     * SSE4.1 (with SSSE3's byte shuffle).
     */
    MOC_SSE41 = 1,
    /**
     * AVX2.
     */
    MOC_AVX2 = 2,
    /**
     * AVX-512 F, BW, DQ and VL.
     */
    MOC_AVX512 = 3,
    /**
     * aarch64's Advanced SIMD.
     */
    MOC_NEON = 16,
    /**
     * WebAssembly's 128-bit SIMD, in modules compiled with it.
     */
    MOC_SIMD128 = 17,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum MOC_Implementation MOC_Implementation;
#else
typedef int32_t MOC_Implementation;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How a triangle is recorded in a sub-tile. Every rule is conservative; they differ in how much information they keep.
 */
enum MOC_UpdateRule
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * One reference depth and two working layers: accurate in nearly every scene and order. The default.
     */
    MOC_UPDATE_RULE_THREE_LAYER = 0,
    /**
     * Hasselgren, Andersson, Akenine-Moller: "Masked Software Occlusion Culling", 2016.
     */
    MOC_UPDATE_RULE_QUICK = 1,
    /**
     * After Andersson, Hasselgren, Akenine-Moller: "Masked Depth Culling for Graphics Hardware", 2015.
     */
    MOC_UPDATE_RULE_ACCURATE = 2,
    /**
     * One reference depth and three working layers: the most accurate rule, and the slowest. It pays off for dense
     * geometry that is drawn unsorted.
     */
    MOC_UPDATE_RULE_FOUR_LAYER = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum MOC_UpdateRule MOC_UpdateRule;
#else
typedef int32_t MOC_UpdateRule;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The direction in which screen rows are counted.
 */
enum MOC_YAxis
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Row 0 is the top of the screen (Direct3D, Vulkan, Metal). The default.
     */
    MOC_Y_AXIS_DOWN = 0,
    /**
     * Row 0 is the bottom of the screen (OpenGL).
     */
    MOC_Y_AXIS_UP = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum MOC_YAxis MOC_YAxis;
#else
typedef int32_t MOC_YAxis;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Which triangles are back-facing and skipped, by their winding in normalised device coordinates (y up).
 */
enum MOC_BackfaceWinding
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * None: both sides are drawn.
     */
    MOC_BACKFACE_NONE = 0,
    /**
     * Clockwise triangles are back-facing.
     */
    MOC_BACKFACE_CW = 1,
    /**
     * Counter-clockwise triangles are back-facing.
     */
    MOC_BACKFACE_CCW = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum MOC_BackfaceWinding MOC_BackfaceWinding;
#else
typedef int32_t MOC_BackfaceWinding;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The result of a draw or a query.
 */
enum MOC_CullingResult
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * It may be visible.
     */
    MOC_VISIBLE = 0,
    /**
     * It is certainly hidden by what was drawn.
     */
    MOC_OCCLUDED = 1,
    /**
     * It is outside the view, or back-facing.
     */
    MOC_VIEW_CULLED = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum MOC_CullingResult MOC_CullingResult;
#else
typedef int32_t MOC_CullingResult;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The frustum planes that a mesh may cross: flags, to be combined with `|`.
 *
 * Only MOC_CLIP_PLANE_NEAR has an effect: without it the object's near plane is not applied (geometry behind the eye
 * is always clipped). Omitting a side plane does not promise that the mesh stays inside it: it is always safe, and
 * never faster.
 */
enum MOC_ClipPlanes
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * No plane.
     */
    MOC_CLIP_PLANE_NONE = 0,
    /**
     * The near plane of MOC_SetNearClipPlane.
     */
    MOC_CLIP_PLANE_NEAR = 1,
    /**
     * x = -w.
     */
    MOC_CLIP_PLANE_LEFT = 2,
    /**
     * x = w.
     */
    MOC_CLIP_PLANE_RIGHT = 4,
    /**
     * y = -w.
     */
    MOC_CLIP_PLANE_BOTTOM = 8,
    /**
     * y = w.
     */
    MOC_CLIP_PLANE_TOP = 16,
    /**
     * The four side planes.
     */
    MOC_CLIP_PLANE_SIDES = 30,
    /**
     * All five.
     */
    MOC_CLIP_PLANE_ALL = 31,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum MOC_ClipPlanes MOC_ClipPlanes;
#else
typedef int32_t MOC_ClipPlanes;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The kind of a recorded call.
 */
enum MOC_RecordedCallKind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * MOC_RenderTriangles or MOC_RenderMesh.
     */
    MOC_RECORDED_RENDER_TRIANGLES = 0,
    /**
     * MOC_TestRect.
     */
    MOC_RECORDED_TEST_RECT = 1,
    /**
     * MOC_TestTriangles or MOC_TestMesh.
     */
    MOC_RECORDED_TEST_TRIANGLES = 2,
    /**
     * MOC_ClearBuffer.
     */
    MOC_RECORDED_CLEAR_BUFFER = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum MOC_RecordedCallKind MOC_RecordedCallKind;
#else
typedef int32_t MOC_RecordedCallKind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * A recording in memory; see MOC_RecordingLoad.
 */
typedef struct MOC_Recording MOC_Recording;

/**
 * A pool of threads that draw into an object; see MOC_ThreadpoolCreate.
 */
typedef struct MOC_Threadpool MOC_Threadpool;

/**
 * Receives a message about a call that was refused, or that probably did not do what was intended: `message` names the
 * function, the argument and the reason, as in "MOC_RenderTriangles: no buffer: call MOC_SetResolution first".
 *
 * `user` is that of MOC_SetMessageCallback. `status` is the MOC_Status that the call is about to return,
 * MOC_STATUS_OK if it was not refused. `message` is in English and valid only during the callback. It is called on
 * the thread that made the call, possibly on several threads concurrently, and while the library holds no lock of
 * its own. It may call the library; refusals of those calls are not reported. It must not throw or longjmp.
 */
typedef void (*MOC_MessageCallback)(void *user, int32_t status, const char *message);

/**
 * Allocates `size` bytes aligned to `alignment` (a power of two; `size` is a multiple of it, as C11's aligned_alloc
 * requires). Returns null if there is no memory. Memory that is not aligned to `alignment` is freed and treated as an
 * allocation failure. Called from any thread that uses the object; must not throw, and must not use the object or the
 * pool that draws into it.
 */
typedef void *(*MOC_AlignedAlloc)(size_t alignment, size_t size);

/**
 * Frees memory allocated by the MOC_AlignedAlloc of the same object. Called from any thread; must not throw.
 */
typedef void (*MOC_AlignedFree)(void *ptr);

/**
 * Calls `alloc(alignment, size)` and returns its result, for languages whose allocators throw: no exception may
 * enter the library, so this function catches it and returns null. It is called wherever `alloc` would be.
 */
typedef void *(*MOC_CallAlloc)(MOC_AlignedAlloc alloc, size_t alignment, size_t size);

/**
 * Settings of an object, fixed at creation. Set `size`, let MOC_DefaultSettings fill in the rest, then change what
 * should differ.
 */
typedef struct MOC_Settings {
    /**
     * sizeof(MOC_Settings).
     */
    uint32_t size;
    /**
     * A MOC_Implementation: the highest instruction set that may be used. Default MOC_AVX512. If it belongs to another
     * architecture, it allows the best available.
     */
    int32_t implementation;
    /**
     * A MOC_UpdateRule that the library was compiled with (by default all). Default MOC_UPDATE_RULE_THREE_LAYER.
     */
    int32_t update_rule;
    /**
     * A MOC_YAxis. Default MOC_Y_AXIS_DOWN.
     */
    int32_t y_axis;
    /**
     * 0 or 1. 1: draws and queries are counted for MOC_GetStatistics, which makes draws about a tenth slower. 0: only
     * dropped triangles are counted (MOC_GetDroppedTriangles). Default 0.
     */
    int32_t statistics;
    /**
     * Allocates the memory of the object and its buffer; recordings and pools use the system's allocator. Null,
     * together with `free`: the system's allocator. Default null.
     */
    MOC_AlignedAlloc alloc;
    /**
     * Frees the memory that `alloc` returned. Null if and only if `alloc` is.
     */
    MOC_AlignedFree free;
    /**
     * Calls `alloc` for the library, for allocators that throw. Null: the library calls `alloc` directly. Ignored if
     * `alloc` is null. Default null.
     */
    MOC_CallAlloc call_alloc;
} MOC_Settings;

/**
 * Where x, y and w (with a matrix: x, y and z) of a vertex are stored, in bytes.
 *
 * Packed x, y, z, w is (16, 4, 12) without a matrix and (16, 4, 8) with one; packed x, y, z with a matrix is (12, 4,
 * 8); a structure of arrays of n vertices is (4, 4 * n, 8 * n); positions inside a larger vertex are (sizeof(vertex),
 * 4, 8) with a matrix, and a pointer to the first x. No alignment is required. Offsets may be negative, except for the
 * functions whose names end in Checked.
 */
typedef struct MOC_VertexLayout {
    /**
     * Bytes from one vertex to the next; not negative.
     */
    int32_t stride;
    /**
     * Bytes from x to y.
     */
    int32_t offset_y;
    /**
     * Bytes from x to w; with a matrix, to z.
     */
    int32_t offset_zw;
} MOC_VertexLayout;

/**
 * Triangles to be drawn, tested, binned or recorded. Zero the struct, then set `size` and the fields that the mesh
 * needs.
 *
 * Every vertex below `vertex_count` must be readable: its x, y and w (or z), and for vertices of 12 or 16 bytes with y
 * at 4 and w (or z) at 8 or 12, also everything in between. With MOC_UNCHECKED this applies to every vertex from the
 * lowest to the highest index, whether or not an index refers to it.
 */
typedef struct MOC_Mesh {
    /**
     * sizeof(MOC_Mesh).
     */
    uint32_t size;
    /**
     * Size of an index in bytes: 4, or 0, which also means 4.
     */
    uint32_t index_size;
    /**
     * The x of the first vertex, at any address. Null is allowed when there are no triangles.
     */
    const float *vertices;
    /**
     * The indices, `uint32_t`, three per triangle. Null is allowed when there are no triangles.
     */
    const void *indices;
    /**
     * Number of vertices: a mesh with an index that is not below it is refused. MOC_UNCHECKED: indices are trusted.
     */
    uint32_t vertex_count;
    /**
     * Number of triangles, 0 to INT32_MAX.
     */
    uint32_t triangle_count;
    /**
     * 16 floats, as in MOC_RenderTriangles. Null: the vertices are in clip space.
     */
    const float *model_to_clip;
    /**
     * Where the coordinates are. Null: packed x, y, z with a matrix (unlike in MOC_RenderTriangles), packed x, y, z, w
     * without one. The last offset is that of z with a matrix, of w without one. Offsets may be negative.
     */
    const struct MOC_VertexLayout *layout;
    /**
     * A MOC_BackfaceWinding, of the triangle as seen on the screen. Zero is MOC_BACKFACE_NONE: both sides are drawn.
     */
    int32_t winding;
    /**
     * MOC_ClipPlanes. MOC_CLIP_PLANE_ALL is always correct; zero is MOC_CLIP_PLANE_NONE.
     */
    int32_t clip_planes;
} MOC_Mesh;

/**
 * A list of projected triangles in memory that the caller owns. MOC_BinTriangles appends to it, and MOC_RenderTrilist
 * draws it.
 */
typedef struct MOC_TriList {
    /**
     * Number of triangles for which `data` has room.
     */
    uint32_t capacity;
    /**
     * Number of triangles in the list. Set it to 0 to start over.
     */
    uint32_t count;
    /**
     * 9 floats per triangle, in a form meant only for MOC_RenderTrilist: x and y in 1/256 pixel, and 1/w, of the three
     * corners.
     */
    float *data;
} MOC_TriList;

/**
 * A rectangle of pixels: `min` inclusive, `max` exclusive. x is in multiples of 32, y of 8; a `max` may also be the
 * width or height of the buffer, as is or rounded up to whole tiles. Rows are counted in the object's y direction.
 */
typedef struct MOC_ScissorRect {
    /**
     * First column.
     */
    int32_t min_x;
    /**
     * First row.
     */
    int32_t min_y;
    /**
     * Column after the last.
     */
    int32_t max_x;
    /**
     * Row after the last.
     */
    int32_t max_y;
} MOC_ScissorRect;

/**
 * Statistics of all draws since the object was created.
 */
typedef struct MOC_OccluderStatistics {
    /**
     * Triangles submitted to be drawn or binned, and those of drawn lists.
     */
    int64_t num_processed_triangles;
    /**
     * Those that are front-facing and whose bounds contain a pixel centre on the screen: counted when they are binned,
     * and again for each list that is drawn.
     */
    int64_t num_rasterized_triangles;
    /**
     * 32x8 tiles in the bounds of such triangles when they are drawn; for a list, only tiles inside the rectangle.
     */
    int64_t num_tiles_traversed;
    /**
     * Tiles in which a triangle changed, or could have changed, a sub-tile.
     */
    int64_t num_tiles_updated;
    /**
     * Tiles in which a reference depth rose.
     */
    int64_t num_tiles_merged;
} MOC_OccluderStatistics;

/**
 * Statistics of all queries since the object was created.
 */
typedef struct MOC_OccludeeStatistics {
    /**
     * Rectangles tested.
     */
    int64_t num_processed_rectangles;
    /**
     * Triangles submitted to be tested (including those after the first visible one).
     */
    int64_t num_processed_triangles;
    /**
     * Those of them that were compared with the buffer, up to the first that may be visible.
     */
    int64_t num_rasterized_triangles;
    /**
     * Tiles whose sub-tiles were compared with a rectangle, and those in the bounds of such triangles.
     */
    int64_t num_tiles_traversed;
} MOC_OccludeeStatistics;

/**
 * All counts of an object, if its settings enable statistics; otherwise zeros. The same on every instruction set.
 * Dropped triangles are always counted, for MOC_GetDroppedTriangles.
 */
typedef struct MOC_Statistics {
    /**
     * sizeof(MOC_Statistics).
     */
    uint32_t size;
    /**
     * Always 0.
     */
    uint32_t reserved;
    /**
     * Counts of draws.
     */
    struct MOC_OccluderStatistics occluders;
    /**
     * Counts of queries.
     */
    struct MOC_OccludeeStatistics occludees;
} MOC_Statistics;

/**
 * Called on each worker thread of a pool when it starts, with the `user` of the settings and the thread's number,
 * counted from 0: to set its priority or affinity, or to register it with a profiler. It must not throw.
 */
typedef void (*MOC_ThreadStart)(void *user, uint32_t number);

/**
 * Settings of MOC_ThreadpoolCreateFrom. Zero the struct, then set `size` and whatever should differ from the defaults.
 */
typedef struct MOC_ThreadpoolSettings {
    /**
     * sizeof(MOC_ThreadpoolSettings).
     */
    uint32_t size;
    /**
     * Worker threads of the pool, 0 to 1024. Fewer are started if there are fewer processors besides the
     * caller's, but at least one. 0: the work is done by the calls that flush or submit, and by
     * MOC_ThreadpoolWorkOnce.
     */
    uint32_t threads;
    /**
     * Columns and rows of bins on the screen; 0: 4. There are at most four bins per thread, none smaller than
     * 128x64 pixels, and the screen is divided into rows first.
     */
    uint32_t bins_w;
    /**
     * See `bins_w`.
     */
    uint32_t bins_h;
    /**
     * How many calls' arrays may still be read when a draw call returns; 0: 32. Small calls are gathered into
     * batches of at most half as many, so a larger number makes them cheaper.
     */
    uint32_t max_jobs;
    /**
     * Processors available to the pool and its caller; 0: as many as the system reports.
     */
    uint32_t processors;
    /**
     * Number of the program's own threads that will call MOC_ThreadpoolWorkOnce. It only affects the number of bins.
     */
    uint32_t external_threads;
    /**
     * Must be 0.
     */
    uint32_t reserved;
    /**
     * Prefix of the thread names, in UTF-8; the thread's number is appended. Null: "culling". It is copied.
     */
    const char *thread_name;
    /**
     * Called by each worker thread when it starts; null: no callback.
     */
    MOC_ThreadStart thread_start;
    /**
     * Passed to `thread_start`.
     */
    void *user;
} MOC_ThreadpoolSettings;

/**
 * The header of a recording.
 */
typedef struct MOC_RecordingInfo {
    /**
     * sizeof(MOC_RecordingInfo).
     */
    uint32_t size;
    /**
     * The near plane, in clip-space w.
     */
    float near_clip_plane;
    /**
     * Width of the buffer in pixels.
     */
    uint32_t width;
    /**
     * Height of the buffer in pixels.
     */
    uint32_t height;
    /**
     * Number of recorded calls.
     */
    uint32_t num_calls;
} MOC_RecordingInfo;

/**
 * A recorded call.
 */
typedef struct MOC_RecordedCall {
    /**
     * sizeof(MOC_RecordedCall).
     */
    uint32_t size;
    /**
     * A MOC_RecordedCallKind.
     */
    int32_t kind;
    /**
     * The MOC_CullingResult that the call returned, or MOC_RESULT_UNKNOWN.
     */
    int32_t result;
    /**
     * For rectangles: x_min, y_min, x_max, y_max in normalised device coordinates, and w_min. Otherwise zeros.
     */
    float rect[5];
    /**
     * For draws and tests of triangles: the mesh, for MOC_RenderMesh and MOC_TestMesh. Otherwise null. Valid until the
     * recording is destroyed.
     */
    const struct MOC_Mesh *mesh;
    /**
     * Number of floats from `mesh->vertices` on.
     */
    size_t vertex_floats;
} MOC_RecordedCall;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * The MOC_ABI_VERSION that the library was built with.
 */
uint32_t MOC_GetAbiVersion(void);

/**
 * An English text for a status, for logs. Never null; valid as long as the library is loaded.
 */
const char *MOC_StatusText(int32_t status);

/**
 * From now on, calls that are refused, on any thread and for any object or pool, are reported to `callback`, with
 * `user` as its first argument; null (the default): none. There is one callback for the whole process.
 *
 * When it returns, another thread may still be running the previous callback.
 *
 * Errors: none.
 *
 * Required:
 * `callback` is null, or meets the requirements of MOC_MessageCallback with `user` on any thread until it is
 * replaced and every call that began before that has returned.
 */
MOC_Status MOC_SetMessageCallback(MOC_MessageCallback callback,
                                  void *user);

/**
 * The MOC_Status of the calling thread's last call, for programs that did not keep it. MOC_GetLastStatus,
 * MOC_StatusText and MOC_GetAbiVersion do not count as calls. MOC_STATUS_OK before the first call.
 */
int32_t MOC_GetLastStatus(void);

/**
 * Writes the default settings to `out`: those that MOC_Create uses if its `settings` are null. The caller sets
 * `out->size` to sizeof(MOC_Settings) before the call; it is not changed.
 *
 * Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_INVALID_SIZE for a `size` that is too small, and nothing is written.
 *
 * Required:
 * `out` is null, or can be read and written for the number of bytes given in its `size`.
 */
MOC_Status MOC_DefaultSettings(struct MOC_Settings *out);

/**
 * Creates an object without a buffer and writes it to `out` (null on errors). It uses the best instruction set that
 * the processor supports and `settings` allow. `settings` are copied; null means the defaults. The caller destroys the
 * object with MOC_Destroy.
 *
 * Errors: MOC_STATUS_NULL_POINTER (if `out` is null, or only one of `alloc` and `free`), MOC_STATUS_INVALID_SIZE for a
 * `size` that is too small, MOC_STATUS_INVALID_ENUM, MOC_STATUS_OUT_OF_MEMORY.
 *
 * Required:
 * `settings` is null or can be read for the number of bytes given in its `size`, `out` is null or can be written. The
 * callbacks behave as documented for MOC_AlignedAlloc and MOC_AlignedFree until the object is destroyed.
 */
MOC_Status MOC_Create(const struct MOC_Settings *settings,
                      MaskedOcclusionCulling **out);

/**
 * Frees the object and its buffer, and ends its recording. If a pool draws into the object, it first draws everything
 * submitted, and has no object afterwards. Null is allowed.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed; nobody uses it any more.
 */
MOC_Status MOC_Destroy(MaskedOcclusionCulling *moc);

/**
 * Gives the object a buffer of `width` by `height` pixels, each from 1 to 16384, and clears it. If the size does not
 * change, the buffer is only cleared. Each sub-tile of 8x4 pixels takes 20 bytes (12 with MOC_UPDATE_RULE_QUICK and
 * MOC_UPDATE_RULE_ACCURATE, 28 with MOC_UPDATE_RULE_FOUR_LAYER).
 *
 * The buffer may be smaller than the screen: that is faster and culls less. But MOC_OCCLUDED then means hidden at the
 * buffer's pixel centres: a gap between occluders that is narrower than a buffer pixel can disappear in the buffer,
 * and what the screen shows through it is then culled. At 320x180 for a screen of 1920x1080, gaps of up to 5 screen
 * pixels can disappear. docs/guide.md says what to do about it.
 *
 * Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_INVALID_SIZE, MOC_STATUS_OUT_OF_MEMORY, MOC_STATUS_BUSY while a pool is
 * drawing into the object. On an error the object keeps its old buffer.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed; no other thread uses it meanwhile.
 */
MOC_Status MOC_SetResolution(MaskedOcclusionCulling *moc,
                             uint32_t width,
                             uint32_t height);

/**
 * Writes the width and height of the buffer in pixels.
 *
 * Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_NO_BUFFER, and 0 by 0 is written.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile. `width`
 * and `height` are null or can be written.
 */
MOC_Status MOC_GetResolution(const MaskedOcclusionCulling *moc, uint32_t *width, uint32_t *height);

/**
 * Writes the size in pixels of a bin when the buffer is divided into `bins_w` by `bins_h` bins: the buffer's width
 * divided by `bins_w`, rounded down to a multiple of 32, and its height divided by `bins_h`, rounded down to a
 * multiple of 8. The last column and row of bins extend to the buffer's edge.
 *
 * Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_NO_BUFFER; MOC_STATUS_INVALID_SIZE if a bin count is 0 or bins would be
 * smaller than 32 by 8. After the last two, 0 by 0 is written.
 *
 * Required:
 * As MOC_GetResolution.
 */
MOC_Status MOC_ComputeBinWidthHeight(const MaskedOcclusionCulling *moc,
                                     uint32_t bins_w,
                                     uint32_t bins_h,
                                     uint32_t *width,
                                     uint32_t *height);

/**
 * Sets the near plane, in clip-space w, for calls whose clip planes include MOC_CLIP_PLANE_NEAR: geometry nearer than
 * the plane is clipped. With 0, the default, or any value below 2^-30, only geometry behind the eye is clipped, and
 * occludees that reach behind it count as visible; so passing the camera's own near plane culls more.
 *
 * Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_INVALID_NUMBER for NaN or an infinity, in which case the plane does not
 * change.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed; no other thread uses it meanwhile.
 */
MOC_Status MOC_SetNearClipPlane(MaskedOcclusionCulling *moc,
                                float near_w);

/**
 * Writes the near plane, in clip-space w.
 *
 * Errors: MOC_STATUS_NULL_POINTER.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile. `out` is
 * null or can be written.
 */
MOC_Status MOC_GetNearClipPlane(const MaskedOcclusionCulling *moc, float *out);

/**
 * Writes the MOC_Implementation that the object uses, which never changes.
 *
 * Errors: MOC_STATUS_NULL_POINTER.
 *
 * Required:
 * As MOC_GetNearClipPlane.
 */
MOC_Status MOC_GetImplementation(const MaskedOcclusionCulling *moc, int32_t *out);

/**
 * Writes the MOC_UpdateRule that the object uses, which never changes.
 *
 * Errors: MOC_STATUS_NULL_POINTER.
 *
 * Required:
 * As MOC_GetNearClipPlane.
 */
MOC_Status MOC_GetUpdateRule(const MaskedOcclusionCulling *moc, int32_t *out);

/**
 * Waits until the pool that draws into the object, if any, has drawn everything submitted: afterwards the object may
 * be used directly as long as no thread calls the pool.
 *
 * Errors: MOC_STATUS_NULL_POINTER.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed.
 */
MOC_Status MOC_Flush(const MaskedOcclusionCulling *moc);

/**
 * Writes the callbacks that the object was created with or, if there were none, a pair that uses the system's
 * allocator. They may still be called, and passed to other objects, after this object is destroyed. Neither pointer
 * may be null.
 *
 * Errors: MOC_STATUS_NULL_POINTER.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile. `alloc` and `free`
 * are null or can be written.
 */
MOC_Status MOC_GetAllocFreeCallback(const MaskedOcclusionCulling *moc,
                                    MOC_AlignedAlloc *alloc,
                                    MOC_AlignedFree *free);

/**
 * Clears every pixel to infinitely far: the first call of a frame. It writes little more than four bytes per 32x8
 * tile.
 *
 * Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_NO_BUFFER, MOC_STATUS_BUSY while a pool is drawing into the object.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed; no other thread uses it meanwhile.
 */
MOC_Status MOC_ClearBuffer(MaskedOcclusionCulling *moc);

/**
 * Merges the buffer of `other` into that of `moc`: afterwards `moc` hides what either of them hid, except for what its
 * few depths cannot represent, and never more. `other` is not changed. The two must have the same resolution and
 * MOC_YAxis; they may differ in instruction set and update rule. Merging an object with itself changes nothing.
 *
 * Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_NO_BUFFER, MOC_STATUS_SIZE_MISMATCH, MOC_STATUS_BUSY while a pool is
 * drawing into either.
 *
 * Required:
 * Both are null or from MOC_Create and not destroyed. No other thread uses `moc` meanwhile, and none
 * changes `other`.
 */
MOC_Status MOC_MergeBuffer(MaskedOcclusionCulling *moc,
                           const MaskedOcclusionCulling *other);

/**
 * Merges the buffers of `count` other objects into that of `moc`: the same bits as calling MOC_MergeBuffer for each of
 * them in that order, but faster. If `moc` itself is among `others`, that entry changes nothing.
 *
 * Errors: as MOC_MergeBuffer, and MOC_STATUS_NULL_POINTER for a null in the array. On an error nothing is merged.
 *
 * Required:
 * `others` is null or can be read for `count` pointers. All objects are null or from MOC_Create and not destroyed.
 * No other thread uses `moc` meanwhile, and none changes the others.
 */
MOC_Status MOC_MergeBuffers(MaskedOcclusionCulling *moc,
                            const MaskedOcclusionCulling *const *others,
                            uint32_t count);

/**
 * Draws occluders: from now on they hide what is behind them. Front-to-back order is fastest and hides most.
 *
 * - `vertices`: the x of the first vertex, at any address. May be null if there are no triangles.
 * - `triangles`: three indices per triangle. May be null if there are no triangles.
 * - `n_triangles`: the number of triangles, 0 or more.
 * - `model_to_clip`: 16 floats m that transform the model's x, y, z to clip space: x' = x*m[0] + y*m[4] + z*m[8] +
 *   m[12], y' with m[1] m[5] m[9] m[13], w' with m[3] m[7] m[11] m[15]; m[2] m[6] m[10] m[14] are not used. OpenGL and
 *   Direct3D store their matrices in this order (docs/conventions.md). Null: the vertices are in clip space.
 * - `winding`: a MOC_BackfaceWinding, of the triangle as seen on the screen.
 * - `clip_planes`: MOC_ClipPlanes. MOC_CLIP_PLANE_ALL is always correct.
 * - `layout`: where the coordinates are. Null: (16, 4, 12), packed x, y, z, w. With a matrix the last offset is that
 *   of z instead of w, so null is wrong: pass (12, 4, 8) for packed x, y, z, or (16, 4, 8) for x, y, z and a fourth
 *   float.
 * - `result`: may be null. Receives MOC_VIEW_CULLED if every triangle is outside the view, back-facing or dropped, or
 *   if there are none; otherwise MOC_VISIBLE.
 *
 * Triangles with a NaN, an infinite coordinate, or a corner farther than 2^40 are dropped; MOC_GetDroppedTriangles
 * counts them.
 *
 * Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_INVALID_ENUM, MOC_STATUS_INVALID_SIZE for a negative count or, with
 * 32-bit pointers, more indices than memory can hold, MOC_STATUS_INVALID_LAYOUT for a negative stride or indices
 * that are not aligned to 4 bytes, MOC_STATUS_NO_BUFFER, MOC_STATUS_BUSY while a pool is drawing into the object.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed; no other thread uses it meanwhile. The indices, the
 * matrix and the layout can be read, and so can every vertex from the lowest to the highest index of the call,
 * whether or not an index names it: its x, y and w (or z), and all between in vertices of 12 or 16 bytes with
 * y at 4 and w (or z) at 8 or 12. For untrusted indices use MOC_RenderTrianglesChecked.
 */
MOC_Status MOC_RenderTriangles(MaskedOcclusionCulling *moc,
                               const float *vertices,
                               const uint32_t *triangles,
                               int32_t n_triangles,
                               const float *model_to_clip,
                               int32_t winding,
                               int32_t clip_planes,
                               const struct MOC_VertexLayout *layout,
                               int32_t *result);

/**
 * As MOC_RenderTriangles, with the length of the vertex array in floats, counted from `vertices`: an index of a vertex
 * that is not entirely inside the array is an error, and nothing is drawn.
 *
 * Errors: as MOC_RenderTriangles, MOC_STATUS_INDEX_OUT_OF_RANGE, and MOC_STATUS_INVALID_LAYOUT also for a negative
 * offset.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed; no other thread uses it meanwhile. `vertices` can be
 * read for `vertex_floats` floats, and so can the indices, the matrix and the layout.
 */
MOC_Status MOC_RenderTrianglesChecked(MaskedOcclusionCulling *moc,
                                      const float *vertices,
                                      size_t vertex_floats,
                                      const uint32_t *triangles,
                                      int32_t n_triangles,
                                      const float *model_to_clip,
                                      int32_t winding,
                                      int32_t clip_planes,
                                      const struct MOC_VertexLayout *layout,
                                      int32_t *result);

/**
 * MOC_RenderTriangles or MOC_RenderTrianglesChecked for a mesh described by a struct.
 *
 * Errors: as those; MOC_STATUS_NULL_POINTER for a null `mesh`, MOC_STATUS_INVALID_SIZE for a `size` that is too
 * small or a `triangle_count` above INT32_MAX, MOC_STATUS_INVALID_ENUM for an `index_size` other than 4 and 0.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed; no other thread uses it meanwhile. `mesh` is null or can be
 * read for the number of bytes given in its `size`, and what it points to as MOC_Mesh says. `result` is null or can
 * be written.
 */
MOC_Status MOC_RenderMesh(MaskedOcclusionCulling *moc,
                          const struct MOC_Mesh *mesh,
                          int32_t *result);

/**
 * Draws a list that MOC_BinTriangles filled, inside `scissor` (null: everywhere). The list is not changed. It may be
 * drawn into any object with the same resolution and MOC_YAxis as the one that filled it.
 *
 * The rectangle's x must be multiples of 32 and its y multiples of 8; max_x may also be the width of the buffer, or
 * that rounded up to a multiple of 32, and max_y the height, or that rounded up to a multiple of 8. Several threads
 * may draw into one object at once, in rectangles that do not overlap, so that each 32x8 tile belongs to one thread.
 *
 * Errors: MOC_STATUS_NULL_POINTER (also for a list that is not empty but has no `data`), MOC_STATUS_NO_BUFFER,
 * MOC_STATUS_BUSY while a pool is drawing into the object, MOC_STATUS_INVALID_SIZE for any other rectangle or for a
 * list whose `count` is above its `capacity` or larger than memory can hold; MOC_STATUS_INVALID_LAYOUT if `list` is
 * misaligned. On an error nothing is drawn.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed. Meanwhile no other thread draws into an overlapping
 * rectangle of it, and none queries, merges, clears or resizes it. `list` can be read, its `data` for
 * 9 * `count` floats.
 */
MOC_Status MOC_RenderTrilist(const MaskedOcclusionCulling *moc,
                             const struct MOC_TriList *list,
                             const struct MOC_ScissorRect *scissor);

/**
 * Tests occludees: if these triangles were drawn now, would any part of them be nearer than what was drawn, or at the
 * same depth?
 *
 * The arguments are those of MOC_RenderTriangles. Every pixel that a triangle touches counts, not only those whose
 * centre it covers. `result` (may be null) receives a MOC_CullingResult. It is MOC_VIEW_CULLED if no front-facing
 * triangle touches a pixel, or if there are no triangles; MOC_OCCLUDED is also possible for triangles that touch no
 * pixel, if all the pixels around them are behind what was drawn. It is MOC_VISIBLE also for triangles with a NaN, an
 * infinite coordinate or a corner farther than 2^40, and on errors. Several threads may test at once.
 *
 * The answer is for the triangles, not for what they enclose. If the bounding box of an object crosses the near plane
 * or contains the eye, its faces may be back-facing, or hidden although the object is not: treat such an object as
 * visible. If the near plane is 0 or MOC_CLIP_PLANE_NEAR is omitted, triangles that reach behind the eye within the
 * view are MOC_VISIBLE.
 *
 * Errors: as MOC_RenderTriangles, except MOC_STATUS_BUSY: while a pool is drawing into the object, the query goes
 * through the pool.
 *
 * Required:
 * As MOC_RenderTriangles, every vertex from the lowest to the highest index included, but other threads may
 * query `moc` meanwhile.
 */
MOC_Status MOC_TestTriangles(const MaskedOcclusionCulling *moc,
                             const float *vertices,
                             const uint32_t *triangles,
                             int32_t n_triangles,
                             const float *model_to_clip,
                             int32_t winding,
                             int32_t clip_planes,
                             const struct MOC_VertexLayout *layout,
                             int32_t *result);

/**
 * As MOC_TestTriangles, with the length of the vertex array in floats: an index of a vertex that is not entirely
 * inside the array is an error.
 *
 * Errors: as MOC_RenderTrianglesChecked.
 *
 * Required:
 * As MOC_RenderTrianglesChecked, but other threads may query `moc` meanwhile.
 */
MOC_Status MOC_TestTrianglesChecked(const MaskedOcclusionCulling *moc,
                                    const float *vertices,
                                    size_t vertex_floats,
                                    const uint32_t *triangles,
                                    int32_t n_triangles,
                                    const float *model_to_clip,
                                    int32_t winding,
                                    int32_t clip_planes,
                                    const struct MOC_VertexLayout *layout,
                                    int32_t *result);

/**
 * MOC_TestTriangles or MOC_TestTrianglesChecked for a mesh described by a struct.
 *
 * Errors: as MOC_RenderMesh, except MOC_STATUS_BUSY.
 *
 * Required:
 * As MOC_RenderMesh, but other threads may query `moc` meanwhile.
 */
MOC_Status MOC_TestMesh(const MaskedOcclusionCulling *moc, const struct MOC_Mesh *mesh, int32_t *result);

/**
 * Tests a rectangle on the screen, such as the bounds of an object's box. docs/conventions.md has code that computes
 * one from a box.
 *
 * - `xmin`, `ymin`, `xmax`, `ymax`: in normalised device coordinates (x right, y up, the screen is -1 to 1, whatever
 *   the MOC_YAxis). They may be off screen or infinite. Every pixel that is touched counts.
 * - `wmin`: the clip-space w of the nearest point. Pass 0 if the object crosses the near plane.
 * - `result`: not null. MOC_VIEW_CULLED if the rectangle is off screen; MOC_OCCLUDED if all of it is behind what was
 *   drawn; otherwise, and at the same depth, MOC_VISIBLE. Also MOC_VISIBLE if a number is NaN, if `wmin` is not
 *   positive, if a minimum is above its maximum, and on errors. A NaN and a minimum above its maximum are reported to
 *   the callback of MOC_SetMessageCallback, although the status is MOC_STATUS_OK.
 *
 * Several threads may test at once.
 *
 * Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_NO_BUFFER.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile. `result` is
 * null or can be written.
 */
MOC_Status MOC_TestRect(const MaskedOcclusionCulling *moc,
                        float xmin,
                        float ymin,
                        float xmax,
                        float ymax,
                        float wmin,
                        int32_t *result);

/**
 * Writes the depth (1/w) of every pixel to `out`: width times height floats, row by row in the object's y direction,
 * negative where nothing was drawn. `flip_y` is 1 to write the last row first, 0 to write the first row first. These
 * are the depths that tests compare with, never nearer than what was drawn.
 *
 * Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_NO_BUFFER, MOC_STATUS_BUSY while a pool is drawing into the object,
 * MOC_STATUS_INVALID_ENUM for any other `flip_y`, MOC_STATUS_INVALID_LAYOUT if `out` is not aligned to 4 bytes.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile. `out` is
 * null or can be written for width times height floats.
 */
MOC_Status MOC_ComputePixelDepthBuffer(const MaskedOcclusionCulling *moc,
                                       float *out,
                                       int32_t flip_y);

/**
 * As MOC_ComputePixelDepthBuffer, with the length of `out` in floats.
 *
 * Errors: as MOC_ComputePixelDepthBuffer, and MOC_STATUS_INVALID_SIZE if `out` is too short.
 *
 * Required:
 * As MOC_ComputePixelDepthBuffer, where `out` can be written for `out_floats` floats.
 */
MOC_Status MOC_ComputePixelDepthBufferChecked(const MaskedOcclusionCulling *moc,
                                              float *out,
                                              size_t out_floats,
                                              int32_t flip_y);

/**
 * Writes the counts since the object was created; they are never reset. The caller sets `out->size` to
 * sizeof(MOC_Statistics) before the call.
 *
 * Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_INVALID_SIZE for a `size` that is too small, and nothing is written.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile. `out` is null, or
 * can be read and written for the number of bytes given in its `size`.
 */
MOC_Status MOC_GetStatistics(const MaskedOcclusionCulling *moc,
                             struct MOC_Statistics *out);

/**
 * Writes the number of triangles dropped by draws since the object was created, because of a NaN, an infinite
 * coordinate, or a distance beyond 2^40. They are counted whether or not the settings ask for statistics.
 *
 * Errors: MOC_STATUS_NULL_POINTER.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile. `out` is null or can
 * be written.
 */
MOC_Status MOC_GetDroppedTriangles(const MaskedOcclusionCulling *moc,
                                   int64_t *out);

/**
 * Projects triangles and appends each one that may be drawn to the list of every bin that it overlaps, to be drawn
 * later by MOC_RenderTrilist. Nothing is drawn.
 *
 * `lists` is an array of `bins_w` times `bins_h` lists, row by row; the caller has set their `data`, `capacity` and
 * `count` (0 at first). The bins are those of MOC_ComputeBinWidthHeight. The other arguments are those of
 * MOC_RenderTriangles. `result` (may be null) receives MOC_VIEW_CULLED if no triangle may be drawn, otherwise
 * MOC_VISIBLE; on errors MOC_VISIBLE. Several threads may bin at once, each into its own lists.
 *
 * Errors: as MOC_RenderTriangles and MOC_ComputeBinWidthHeight; MOC_STATUS_NULL_POINTER also for a list with a
 * capacity but no `data`; MOC_STATUS_INVALID_LAYOUT also if `lists` is misaligned; MOC_STATUS_INVALID_SIZE also for a
 * capacity larger than memory can hold. In all these cases nothing is binned. MOC_STATUS_LIST_FULL: a list is full;
 * the triangles that fitted are in the lists.
 *
 * Required:
 * As MOC_TestTriangles, every vertex from the lowest to the highest index included. `lists` is null or can be
 * written for `bins_w` times `bins_h` lists, and the `data` of each for 9 * `capacity` floats; nobody else uses
 * them meanwhile.
 */
MOC_Status MOC_BinTriangles(const MaskedOcclusionCulling *moc,
                            const float *vertices,
                            const uint32_t *triangles,
                            int32_t n_triangles,
                            struct MOC_TriList *lists,
                            uint32_t bins_w,
                            uint32_t bins_h,
                            const float *model_to_clip,
                            int32_t winding,
                            int32_t clip_planes,
                            const struct MOC_VertexLayout *layout,
                            int32_t *result);

/**
 * As MOC_BinTriangles, with the length of the vertex array in floats: an index of a vertex that is not entirely inside
 * the array is an error, and nothing is binned.
 *
 * Errors: as MOC_BinTriangles and MOC_RenderTrianglesChecked.
 *
 * Required:
 * As MOC_BinTriangles, where `vertices` can be read for `vertex_floats` floats, whatever the indices.
 */
MOC_Status MOC_BinTrianglesChecked(const MaskedOcclusionCulling *moc,
                                   const float *vertices,
                                   size_t vertex_floats,
                                   const uint32_t *triangles,
                                   int32_t n_triangles,
                                   struct MOC_TriList *lists,
                                   uint32_t bins_w,
                                   uint32_t bins_h,
                                   const float *model_to_clip,
                                   int32_t winding,
                                   int32_t clip_planes,
                                   const struct MOC_VertexLayout *layout,
                                   int32_t *result);

/**
 * MOC_BinTriangles or MOC_BinTrianglesChecked for a mesh described by a struct.
 *
 * Errors: as those and as MOC_RenderMesh.
 *
 * Required:
 * As MOC_TestMesh. `lists` is null or can be written for `bins_w` times `bins_h` lists, and the `data` of each for
 * 9 * `capacity` floats; nobody else uses them meanwhile.
 */
MOC_Status MOC_BinMesh(const MaskedOcclusionCulling *moc,
                       const struct MOC_Mesh *mesh,
                       struct MOC_TriList *lists,
                       uint32_t bins_w,
                       uint32_t bins_h,
                       int32_t *result);

/**
 * Transforms `n_vertices` positions (x, y, z, 1) by `matrix` (16 floats, as in MOC_RenderTriangles) and writes them to
 * `out` as packed x, y, z, w, 16 bytes per vertex: the form that draws and tests without a matrix take. Draws and
 * tests with the matrix give the same bits without a second array. No object is needed.
 *
 * `vertices` points to the x of the first vertex; `layout` says where the other coordinates are (null: packed x, y, z,
 * 12 bytes per vertex); its last offset is that of z. No alignment is required.
 *
 * Errors: MOC_STATUS_NULL_POINTER (`vertices` and `out` may be null if there are no vertices),
 * MOC_STATUS_INVALID_LAYOUT for a negative stride, MOC_STATUS_INVALID_SIZE for more vertices than memory can hold.
 *
 * Required:
 * `matrix` and `layout` are null or can be read, and so can `n_vertices` vertices. `out` can be written for
 * 4 * `n_vertices` floats, and does not overlap the vertices.
 */
MOC_Status MOC_TransformVertices(const float *matrix,
                                 const float *vertices,
                                 float *out,
                                 uint32_t n_vertices,
                                 const struct MOC_VertexLayout *layout);

/**
 * Creates a pool of `threads` threads (0 to 1024) and writes it to `out` (null on errors). If fewer of the
 * `processors` are left besides the caller's, fewer threads are started, but at least one; `processors` 0 means as
 * many as the system reports. The threads sleep until MOC_ThreadpoolWakeThreads, and whenever there is nothing to do.
 * The caller destroys the pool with MOC_ThreadpoolDestroy.
 *
 * Once: MOC_ThreadpoolSetBuffer, MOC_ThreadpoolWakeThreads. Each frame: MOC_ThreadpoolClearBuffer; a matrix and a draw
 * for each mesh; MOC_ThreadpoolFlush; tests.
 *
 * Draw calls return at once. The threads draw into `bins_w` times `bins_h` bins of the screen (at most four per
 * thread, none smaller than 128x64 pixels; the screen is divided into rows first), within each bin in the order of the
 * calls, so the buffer has the same bits as if one thread drew it. While a worker thread is awake, submitted work is
 * drawn without a further call. With none awake, or none at all, it waits for MOC_ThreadpoolWakeThreads,
 * MOC_ThreadpoolFlush, MOC_ThreadpoolSuspendThreads or MOC_ThreadpoolWorkOnce.
 *
 * At most `max_jobs` calls still read their arrays when a draw call returns; beyond that the caller helps until this
 * is so again. A program that rotates among `max_jobs` + 1 arrays therefore needs no flush before it overwrites one.
 *
 * Several threads may submit and query at once, and call every other function of the pool except
 * MOC_ThreadpoolDestroy.
 *
 * Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_INVALID_SIZE if `bins_w`, `bins_h` or `max_jobs` is 0 or `threads` is
 * above 1024, MOC_STATUS_OUT_OF_MEMORY if the system cannot start the threads.
 *
 * Required:
 * `out` is null or can be written.
 */
MOC_Status MOC_ThreadpoolCreate(uint32_t threads,
                                uint32_t bins_w,
                                uint32_t bins_h,
                                uint32_t max_jobs,
                                uint32_t processors,
                                struct MOC_Threadpool **out);

/**
 * MOC_ThreadpoolCreate with more settings: pools whose work is done by the program's own job system, thread names,
 * and a callback when a thread starts.
 *
 * Errors: as MOC_ThreadpoolCreate, and MOC_STATUS_NULL_POINTER for the settings, MOC_STATUS_INVALID_SIZE for a
 * `size` that is too small, MOC_STATUS_INVALID_ENUM for a `reserved` that is not 0.
 *
 * Required:
 * `settings` is null or can be read for the number of bytes given in its `size`, its `thread_name` is null or a C
 * string, and its `thread_start` may be called with its `user` by any thread. `out` is null or can be written.
 */
MOC_Status MOC_ThreadpoolCreateFrom(const struct MOC_ThreadpoolSettings *settings,
                                    struct MOC_Threadpool **out);

/**
 * Draws everything submitted, ends the threads, and frees the pool; the object that it drew into remains. Null is
 * allowed.
 *
 * Required:
 * `pool` is null or from MOC_ThreadpoolCreate and not destroyed; nobody uses it any more. The arrays of the calls
 * submitted since the last MOC_ThreadpoolFlush can still be read.
 */
MOC_Status MOC_ThreadpoolDestroy(struct MOC_Threadpool *pool);

/**
 * Wakes the threads, so that they draw what is submitted. Has no effect if they are already awake.
 *
 * Errors: MOC_STATUS_NULL_POINTER.
 *
 * Required:
 * `pool` is null or from MOC_ThreadpoolCreate and not destroyed.
 */
MOC_Status MOC_ThreadpoolWakeThreads(const struct MOC_Threadpool *pool);

/**
 * Draws everything submitted, then puts the threads to sleep. Draw calls are still accepted; they wait until the
 * threads are woken, or until a call flushes or does the work (MOC_ThreadpoolWorkOnce).
 *
 * Errors: MOC_STATUS_NULL_POINTER.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads.
 */
MOC_Status MOC_ThreadpoolSuspendThreads(const struct MOC_Threadpool *pool);

/**
 * Waits until everything submitted before is drawn. Afterwards the arrays of those calls may be changed or freed and,
 * as long as no thread calls the pool, the object may be drawn into directly.
 *
 * Errors: MOC_STATUS_NULL_POINTER.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads.
 */
MOC_Status MOC_ThreadpoolFlush(const struct MOC_Threadpool *pool);

/**
 * Does one piece of pending work on the calling thread and returns: for jobs of the program's own job system,
 * alongside the pool's threads or instead of them. Writes 1 to `worked` (null is allowed), or 0 if nothing is
 * pending that is not already being worked on. A piece is one batch of calls to project, or the batches one bin has
 * to draw: usually tens of microseconds.
 *
 * Errors: MOC_STATUS_NULL_POINTER.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads. `worked` is null or can be written.
 */
MOC_Status MOC_ThreadpoolWorkOnce(const struct MOC_Threadpool *pool,
                                  int32_t *worked);

/**
 * Writes 1 if everything submitted is drawn, otherwise 0. Calling MOC_ThreadpoolWorkOnce in a loop until then is a
 * flush that never sleeps.
 *
 * Errors: MOC_STATUS_NULL_POINTER.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads. `done` is null or can be written.
 */
MOC_Status MOC_ThreadpoolIsDone(const struct MOC_Threadpool *pool,
                                int32_t *done);

/**
 * Writes the number of the pool's worker threads: fewer than requested if there are fewer processors.
 *
 * Errors: MOC_STATUS_NULL_POINTER.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads. `threads` is null or can be written.
 */
MOC_Status MOC_ThreadpoolGetThreads(const struct MOC_Threadpool *pool, uint32_t *threads);

/**
 * Writes the number of columns and rows of bins, which depends on the resolution.
 *
 * Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_NO_BUFFER, in which case 0 by 0 is written.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads. `bins_w` and `bins_h` are null or can be written.
 */
MOC_Status MOC_ThreadpoolGetBins(const struct MOC_Threadpool *pool, uint32_t *bins_w, uint32_t *bins_h);

/**
 * Makes the pool draw into `moc` from now on (null: into no object), once everything submitted before is drawn. The
 * object keeps its near plane.
 *
 * The object may be destroyed before or after the pool. MOC_TestRect and MOC_TestTriangles may query it on any
 * thread, even while the pool draws or clears (but not while this function or MOC_ThreadpoolSetResolution runs):
 * they answer from what has been drawn so far. Calls that would change or copy its buffer while work is in flight
 * are refused (MOC_STATUS_BUSY); MOC_Flush waits for the pool.
 *
 * Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_BUSY if `moc` belongs to another pool, and nothing is changed.
 *
 * Required:
 * `pool` is null or from MOC_ThreadpoolCreate and not destroyed. `moc` is null or from MOC_Create and not destroyed;
 * no other thread uses it or the pool's previous object meanwhile.
 */
MOC_Status MOC_ThreadpoolSetBuffer(const struct MOC_Threadpool *pool,
                                   MaskedOcclusionCulling *moc);

/**
 * MOC_SetResolution on the pool's object, once everything submitted is drawn.
 *
 * Errors: as there, and MOC_STATUS_NO_BUFFER if the pool has no object.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads. Meanwhile no thread queries the object other than through the pool.
 */
MOC_Status MOC_ThreadpoolSetResolution(const struct MOC_Threadpool *pool, uint32_t width, uint32_t height);

/**
 * MOC_ThreadpoolFlush, then MOC_SetNearClipPlane on the pool's object.
 *
 * Errors: as there, and MOC_STATUS_NO_BUFFER if the pool has no object.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads.
 */
MOC_Status MOC_ThreadpoolSetNearClipPlane(const struct MOC_Threadpool *pool, float near);

/**
 * Sets the matrix of the calling thread's later calls: 16 floats as in MOC_RenderTriangles, which are copied. Null: no
 * matrix, the vertices are in clip space. A thread that has never set a matrix or layout on this pool uses those most
 * recently set by any thread, so one thread may set them and another draw. MOC_ThreadpoolRenderMesh takes both from
 * the mesh.
 *
 * Errors: MOC_STATUS_NULL_POINTER for the pool.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads. `model_to_clip` is null or can be read for 16 floats.
 */
MOC_Status MOC_ThreadpoolSetMatrix(const struct MOC_Threadpool *pool,
                                   const float *model_to_clip);

/**
 * Sets the vertex layout of the calling thread's later calls. Null: (16, 4, 12), packed x, y, z, w, which is wrong
 * with a matrix, because the last offset is then that of z. A thread that has never set one uses the most recent, as
 * in MOC_ThreadpoolSetMatrix.
 *
 * Errors: MOC_STATUS_NULL_POINTER for the pool; MOC_STATUS_INVALID_LAYOUT for a negative stride.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads. `layout` is null or can be read.
 */
MOC_Status MOC_ThreadpoolSetVertexLayout(const struct MOC_Threadpool *pool,
                                         const struct MOC_VertexLayout *layout);

/**
 * MOC_ThreadpoolFlush, then clears the object's buffer: the first call of a frame. When it returns, the buffer is
 * clear, and the arrays of all earlier calls may be changed or freed.
 *
 * Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_NO_BUFFER.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads.
 */
MOC_Status MOC_ThreadpoolClearBuffer(const struct MOC_Threadpool *pool);

/**
 * MOC_RenderTriangles with the calling thread's matrix and vertex layout. It returns at once, like
 * MOC_ThreadpoolRenderMesh.
 *
 * Errors: as MOC_RenderTriangles. Triangles dropped later are counted in the object's statistics.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads. The indices, and every vertex from the lowest to the highest index, can be read and
 * stay unchanged as those of MOC_ThreadpoolRenderMesh.
 */
MOC_Status MOC_ThreadpoolRenderTriangles(const struct MOC_Threadpool *pool,
                                         const float *vertices,
                                         const uint32_t *triangles,
                                         int32_t n_triangles,
                                         int32_t winding,
                                         int32_t clip_planes);

/**
 * Submits occluders and returns at once, unless more than `max_jobs` calls still read their arrays: then the calling
 * thread helps until that is no longer so. The struct, its matrix and its layout are copied. The near plane is the
 * object's.
 *
 * Errors: as MOC_RenderMesh. Triangles dropped later are counted in the object's statistics.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads. `mesh` is null or can be read for the number of bytes given in its `size`, and what
 * it points to as MOC_Mesh says. The vertices and indices stay unchanged until MOC_ThreadpoolFlush,
 * MOC_ThreadpoolClearBuffer or MOC_ThreadpoolSetNearClipPlane returns, or `max_jobs` later calls do.
 */
MOC_Status MOC_ThreadpoolRenderMesh(const struct MOC_Threadpool *pool,
                                    const struct MOC_Mesh *mesh);

/**
 * MOC_TestMesh against what has been drawn so far.
 *
 * Errors: as there.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads and MOC_TestMesh.
 */
MOC_Status MOC_ThreadpoolTestMesh(const struct MOC_Threadpool *pool,
                                  const struct MOC_Mesh *mesh,
                                  int32_t *result);

/**
 * MOC_TestRect against what has been drawn so far. Work that is submitted but not yet drawn hides nothing.
 *
 * Errors: as there.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads. `result` is null or can be written.
 */
MOC_Status MOC_ThreadpoolTestRect(const struct MOC_Threadpool *pool,
                                  float xmin,
                                  float ymin,
                                  float xmax,
                                  float ymax,
                                  float wmin,
                                  int32_t *result);

/**
 * MOC_TestTriangles with the calling thread's matrix and vertex layout, against what has been drawn so far.
 *
 * Errors: as there.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads and MOC_TestTriangles. `result` is null or can be written.
 */
MOC_Status MOC_ThreadpoolTestTriangles(const struct MOC_Threadpool *pool,
                                       const float *vertices,
                                       const uint32_t *triangles,
                                       int32_t n_triangles,
                                       int32_t winding,
                                       int32_t clip_planes,
                                       int32_t *result);

/**
 * MOC_ComputePixelDepthBuffer for the pool's object, once everything submitted is drawn.
 *
 * Errors: as there.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads and MOC_ComputePixelDepthBuffer.
 */
MOC_Status MOC_ThreadpoolComputePixelDepthBuffer(const struct MOC_Threadpool *pool,
                                                 float *out,
                                                 int32_t flip_y);

/**
 * Merges the buffers of `count` other objects into the pool's, in order with the calls before and after it. The result
 * is that of MOC_MergeBuffers; each thread merges parts of the screen.
 *
 * Errors: as there; on an error nothing is merged.
 *
 * Required:
 * As MOC_ThreadpoolWakeThreads and MOC_MergeBuffers. Nobody changes or destroys the other objects until a flushing
 * call returns.
 */
MOC_Status MOC_ThreadpoolMergeBuffers(const struct MOC_Threadpool *pool,
                                      const MaskedOcclusionCulling *const *others,
                                      uint32_t count);

/**
 * Records clears, draws and queries into a file from now on, to be read by MOC_RecordingLoad; see docs/recordings.md
 * for the format. `path` is UTF-8 on Windows, whatever the code page; on Unix its bytes are passed on unchanged.
 * Changing the near plane or the resolution ends a recording that already contains a call. Merges and triangle lists
 * are not recorded.
 *
 * Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_NO_BUFFER, MOC_STATUS_BUSY if it is already recording, MOC_STATUS_FILE
 * if the file cannot be created, or on Windows if `path` is not UTF-8.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile; `path` is null or
 * ends with a zero.
 */
MOC_Status MOC_RecorderStart(const MaskedOcclusionCulling *moc,
                             const char *path);

/**
 * Ends the recording; does nothing if there is none. Destroying an object also ends its recording.
 *
 * Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_FILE if anything could not be written, now or earlier.
 *
 * Required:
 * `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile.
 */
MOC_Status MOC_RecorderStop(const MaskedOcclusionCulling *moc);

/**
 * Records a draw that does not go through MOC_RenderTriangles, such as that of a binned mesh. `result`: a
 * MOC_CullingResult, or MOC_RESULT_UNKNOWN. Does nothing if the object is not recording.
 *
 * Errors: as MOC_RenderTriangles; on an error nothing is recorded.
 *
 * Required:
 * As MOC_RenderTriangles; other threads may use `moc` as they may during a query.
 */
MOC_Status MOC_RecordRenderTriangles(const MaskedOcclusionCulling *moc,
                                     const float *vertices,
                                     const uint32_t *triangles,
                                     int32_t n_triangles,
                                     const float *model_to_clip,
                                     int32_t winding,
                                     int32_t clip_planes,
                                     const struct MOC_VertexLayout *layout,
                                     int32_t result);

/**
 * MOC_RecordRenderTriangles for a mesh described by a struct.
 *
 * Errors: as MOC_RenderMesh; on an error nothing is recorded.
 *
 * Required:
 * As MOC_RenderMesh; other threads may use `moc` as they may during a query.
 */
MOC_Status MOC_RecordMesh(const MaskedOcclusionCulling *moc, const struct MOC_Mesh *mesh, int32_t result);

/**
 * Reads a recording and writes it to `out` (null on errors). `path` is as for MOC_RecorderStart: UTF-8 on Windows. The
 * caller destroys the recording with MOC_RecordingDestroy. Several threads may read from one recording at once.
 *
 * Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_FILE if the file cannot be read, or on Windows if `path` is not UTF-8,
 * MOC_STATUS_OUT_OF_MEMORY, MOC_STATUS_INVALID_RECORDING for one that is empty, truncated or corrupt.
 *
 * Required:
 * `path` is null or ends with a zero, `out` is null or can be written.
 */
MOC_Status MOC_RecordingLoad(const char *path,
                             struct MOC_Recording **out);

/**
 * Like MOC_RecordingLoad, for a file already in memory. `bytes` may be freed once the call returns.
 *
 * Errors: MOC_STATUS_NULL_POINTER if `out` is null, or `bytes` is and `size` is not 0, MOC_STATUS_INVALID_RECORDING,
 * MOC_STATUS_OUT_OF_MEMORY.
 *
 * Required:
 * `bytes` is null or can be read for `size` bytes, `out` is null or can be written.
 */
MOC_Status MOC_RecordingFromMemory(const uint8_t *bytes,
                                   size_t size,
                                   struct MOC_Recording **out);

/**
 * Frees a recording. Null is allowed.
 *
 * Required:
 * `recording` is null or from MOC_RecordingLoad or MOC_RecordingFromMemory, and not destroyed.
 */
MOC_Status MOC_RecordingDestroy(struct MOC_Recording *recording);

/**
 * Writes the header of the recording to `out`. The caller sets `out->size` to sizeof(MOC_RecordingInfo) before the
 * call.
 *
 * Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_INVALID_SIZE for a `size` that is too small, and nothing is written.
 *
 * Required:
 * `recording` is null or a live one. `out` is null, or can be read and written for the number of bytes given in its
 * `size`.
 */
MOC_Status MOC_RecordingGetInfo(const struct MOC_Recording *recording,
                                struct MOC_RecordingInfo *out);

/**
 * Writes the recorded call number `index`, counted from 0, to `out`. The caller sets `out->size` to
 * sizeof(MOC_RecordedCall) before the call. The memory that its pointers refer to belongs to the recording and is
 * freed with it.
 *
 * Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_INDEX_OUT_OF_RANGE, MOC_STATUS_INVALID_SIZE for a `size` that is too
 * small; nothing is written.
 *
 * Required:
 * `recording` is null or a live one. `out` is null, or can be read and written for the number of bytes given in its
 * `size`.
 */
MOC_Status MOC_RecordingGetCall(const struct MOC_Recording *recording,
                                uint32_t index,
                                struct MOC_RecordedCall *out);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

MOC_NAMESPACE_END
#include "moc_names_end.h"

#endif  /* MASKED_OCCLUSION_CULLING_C_H */
