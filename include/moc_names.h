/*
 * The names of the C functions where the library was built with a prefix: with MOC_SYMBOL_PREFIX=acme_ it exports
 * acme_MOC_Create instead of MOC_Create. docs/migrating.md ("Names that collide") explains when and how.
 *
 * The program also defines MOC_SYMBOL_PREFIX as acme_, on the command line or before the first include. Between this file and
 * moc_names_end.h, MOC_Create then means acme_MOC_Create. Each header includes this file at its beginning and moc_names_end.h
 * at its end, so every name listed here is free for the program's own functions. A source file that wants to write MOC_Create
 * includes this file after the other headers. Without MOC_SYMBOL_PREFIX nothing here has any effect.
 *
 * No include guard: every header includes it again. SPDX-License-Identifier: Apache-2.0 OR MIT
 */

/*
 * In C++ all declarations are in an inline namespace named after the prefix: the linker merges inline functions of the same
 * name, and would otherwise mix the methods of two copies of the library in one program. A forward declaration is written
 *
 *     MOC_NAMESPACE_BEGIN class MaskedOcclusionCulling; MOC_NAMESPACE_END
 *
 * or replaced by including masked_occlusion_culling.h.
 */
#ifndef MOC_NAMESPACE_BEGIN
#ifdef MOC_SYMBOL_PREFIX
#define MOC_DETAIL_JOIN_TOKENS(prefix, name) prefix##name
#define MOC_DETAIL_JOIN(prefix, name) MOC_DETAIL_JOIN_TOKENS(prefix, name)
#endif
#if defined(MOC_SYMBOL_PREFIX) && defined(__cplusplus)
#define MOC_NAMESPACE_BEGIN inline namespace MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_Names) {
#define MOC_NAMESPACE_END }
#else
#define MOC_NAMESPACE_BEGIN
#define MOC_NAMESPACE_END
#endif
#endif

#ifdef MOC_SYMBOL_PREFIX
#ifndef MOC_DETAIL_JOIN
#error "MOC_SYMBOL_PREFIX must be defined before the first header of the library is included"
#endif
/* The functions of src/capi, by `UPDATE_HEADER=1 cargo test --test header`. */
#define MOC_GetAbiVersion MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_GetAbiVersion)
#define MOC_StatusText MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_StatusText)
#define MOC_SetMessageCallback MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_SetMessageCallback)
#define MOC_GetLastStatus MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_GetLastStatus)
#define MOC_DefaultSettings MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_DefaultSettings)
#define MOC_Create MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_Create)
#define MOC_Destroy MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_Destroy)
#define MOC_SetResolution MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_SetResolution)
#define MOC_GetResolution MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_GetResolution)
#define MOC_ComputeBinWidthHeight MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ComputeBinWidthHeight)
#define MOC_SetNearClipPlane MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_SetNearClipPlane)
#define MOC_GetNearClipPlane MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_GetNearClipPlane)
#define MOC_GetImplementation MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_GetImplementation)
#define MOC_GetUpdateRule MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_GetUpdateRule)
#define MOC_Flush MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_Flush)
#define MOC_GetAllocFreeCallback MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_GetAllocFreeCallback)
#define MOC_ClearBuffer MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ClearBuffer)
#define MOC_MergeBuffer MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_MergeBuffer)
#define MOC_MergeBuffers MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_MergeBuffers)
#define MOC_RenderTriangles MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_RenderTriangles)
#define MOC_RenderTrianglesChecked MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_RenderTrianglesChecked)
#define MOC_RenderMesh MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_RenderMesh)
#define MOC_RenderTrilist MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_RenderTrilist)
#define MOC_TestTriangles MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_TestTriangles)
#define MOC_TestTrianglesChecked MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_TestTrianglesChecked)
#define MOC_TestMesh MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_TestMesh)
#define MOC_TestRect MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_TestRect)
#define MOC_ComputePixelDepthBuffer MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ComputePixelDepthBuffer)
#define MOC_ComputePixelDepthBufferChecked MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ComputePixelDepthBufferChecked)
#define MOC_GetStatistics MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_GetStatistics)
#define MOC_GetDroppedTriangles MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_GetDroppedTriangles)
#define MOC_BinTriangles MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_BinTriangles)
#define MOC_BinTrianglesChecked MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_BinTrianglesChecked)
#define MOC_BinMesh MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_BinMesh)
#define MOC_TransformVertices MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_TransformVertices)
#define MOC_ThreadpoolCreate MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolCreate)
#define MOC_ThreadpoolCreateFrom MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolCreateFrom)
#define MOC_ThreadpoolDestroy MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolDestroy)
#define MOC_ThreadpoolWakeThreads MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolWakeThreads)
#define MOC_ThreadpoolSuspendThreads MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolSuspendThreads)
#define MOC_ThreadpoolFlush MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolFlush)
#define MOC_ThreadpoolWorkOnce MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolWorkOnce)
#define MOC_ThreadpoolIsDone MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolIsDone)
#define MOC_ThreadpoolGetThreads MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolGetThreads)
#define MOC_ThreadpoolGetBins MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolGetBins)
#define MOC_ThreadpoolSetBuffer MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolSetBuffer)
#define MOC_ThreadpoolSetResolution MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolSetResolution)
#define MOC_ThreadpoolSetNearClipPlane MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolSetNearClipPlane)
#define MOC_ThreadpoolSetMatrix MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolSetMatrix)
#define MOC_ThreadpoolSetVertexLayout MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolSetVertexLayout)
#define MOC_ThreadpoolClearBuffer MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolClearBuffer)
#define MOC_ThreadpoolRenderTriangles MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolRenderTriangles)
#define MOC_ThreadpoolRenderMesh MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolRenderMesh)
#define MOC_ThreadpoolTestMesh MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolTestMesh)
#define MOC_ThreadpoolTestRect MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolTestRect)
#define MOC_ThreadpoolTestTriangles MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolTestTriangles)
#define MOC_ThreadpoolComputePixelDepthBuffer MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolComputePixelDepthBuffer)
#define MOC_ThreadpoolMergeBuffers MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_ThreadpoolMergeBuffers)
#define MOC_RecorderStart MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_RecorderStart)
#define MOC_RecorderStop MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_RecorderStop)
#define MOC_RecordRenderTriangles MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_RecordRenderTriangles)
#define MOC_RecordMesh MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_RecordMesh)
#define MOC_RecordingLoad MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_RecordingLoad)
#define MOC_RecordingFromMemory MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_RecordingFromMemory)
#define MOC_RecordingDestroy MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_RecordingDestroy)
#define MOC_RecordingGetInfo MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_RecordingGetInfo)
#define MOC_RecordingGetCall MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, MOC_RecordingGetCall)
/* To here. */
#endif
