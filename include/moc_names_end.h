/*
 * Undefines what moc_names.h defines, so that the names are free for the program. No include guard.
 *
 * SPDX-License-Identifier: Apache-2.0 OR MIT
 */
#ifdef MOC_SYMBOL_PREFIX
/* The functions of src/capi, by `UPDATE_HEADER=1 cargo test --test header`. */
#undef MOC_GetAbiVersion
#undef MOC_StatusText
#undef MOC_SetMessageCallback
#undef MOC_GetLastStatus
#undef MOC_DefaultSettings
#undef MOC_Create
#undef MOC_Destroy
#undef MOC_SetResolution
#undef MOC_GetResolution
#undef MOC_ComputeBinWidthHeight
#undef MOC_SetNearClipPlane
#undef MOC_GetNearClipPlane
#undef MOC_GetImplementation
#undef MOC_GetUpdateRule
#undef MOC_Flush
#undef MOC_GetAllocFreeCallback
#undef MOC_ClearBuffer
#undef MOC_MergeBuffer
#undef MOC_MergeBuffers
#undef MOC_RenderTriangles
#undef MOC_RenderTrianglesChecked
#undef MOC_RenderMesh
#undef MOC_RenderTrilist
#undef MOC_TestTriangles
#undef MOC_TestTrianglesChecked
#undef MOC_TestMesh
#undef MOC_TestRect
#undef MOC_ComputePixelDepthBuffer
#undef MOC_ComputePixelDepthBufferChecked
#undef MOC_GetStatistics
#undef MOC_GetDroppedTriangles
#undef MOC_BinTriangles
#undef MOC_BinTrianglesChecked
#undef MOC_BinMesh
#undef MOC_TransformVertices
#undef MOC_ThreadpoolCreate
#undef MOC_ThreadpoolCreateFrom
#undef MOC_ThreadpoolDestroy
#undef MOC_ThreadpoolWakeThreads
#undef MOC_ThreadpoolSuspendThreads
#undef MOC_ThreadpoolFlush
#undef MOC_ThreadpoolWorkOnce
#undef MOC_ThreadpoolIsDone
#undef MOC_ThreadpoolGetThreads
#undef MOC_ThreadpoolGetBins
#undef MOC_ThreadpoolSetBuffer
#undef MOC_ThreadpoolSetResolution
#undef MOC_ThreadpoolSetNearClipPlane
#undef MOC_ThreadpoolSetMatrix
#undef MOC_ThreadpoolSetVertexLayout
#undef MOC_ThreadpoolClearBuffer
#undef MOC_ThreadpoolRenderTriangles
#undef MOC_ThreadpoolRenderMesh
#undef MOC_ThreadpoolTestMesh
#undef MOC_ThreadpoolTestRect
#undef MOC_ThreadpoolTestTriangles
#undef MOC_ThreadpoolComputePixelDepthBuffer
#undef MOC_ThreadpoolMergeBuffers
#undef MOC_RecorderStart
#undef MOC_RecorderStop
#undef MOC_RecordRenderTriangles
#undef MOC_RecordMesh
#undef MOC_RecordingLoad
#undef MOC_RecordingFromMemory
#undef MOC_RecordingDestroy
#undef MOC_RecordingGetInfo
#undef MOC_RecordingGetCall
/* To here. */
#endif
