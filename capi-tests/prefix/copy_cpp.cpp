// One copy of the library in C++: compiled without changes, and with MOC_SYMBOL_PREFIX; unoptimised, so that inline
// methods are functions, which the linker merges by name. Returns 0, or the line of the failed check.
#include <stdio.h>

#include <vector>

// Forward declarations as engines write them in their own headers: plain without a prefix, with the macros of moc_names.h if
// there is one.
#ifndef MOC_SYMBOL_PREFIX
class MaskedOcclusionCulling;
#else
#include "moc_names.h"
MOC_NAMESPACE_BEGIN class MaskedOcclusionCulling; MOC_NAMESPACE_END
#endif
struct Engine
{
    MaskedOcclusionCulling *moc;
};

#include "CullingThreadpool.h"
#include "FrameRecorder.h"
#include "MaskedOcclusionCulling.h"

#ifdef MOC_SYMBOL_PREFIX
#define NAME acme_in_cpp
#define RECORDING "acme.mocrec"
#else
#define NAME plain_in_cpp
#define RECORDING "plain.mocrec"
#endif

#define EXPECT(condition)    \
    do                       \
    {                        \
        if (!(condition))    \
            return __LINE__; \
    } while (0)

extern "C" int NAME(float side)
{
    const float wall[] = {0, -5, 0, 5, side * 5, -5, 0, 5, side * 5, 5, 0, 5, 0, 5, 0, 5};
    const unsigned int triangles[] = {0, 1, 2, 0, 2, 3};
    Engine engine = {MaskedOcclusionCulling::Create()};
    EXPECT(engine.moc != nullptr);
    engine.moc->SetResolution(256, 128);
    EXPECT(engine.moc->RecorderStart(RECORDING));
    engine.moc->ClearBuffer();
    engine.moc->RenderTriangles(wall, triangles, 2, nullptr, MaskedOcclusionCulling::BACKFACE_NONE);
    EXPECT(engine.moc->TestRect(side * 0.5f - 0.2f, -0.2f, side * 0.5f + 0.2f, 0.2f, 8) ==
           MaskedOcclusionCulling::OCCLUDED);
    EXPECT(engine.moc->TestRect(-side * 0.5f - 0.2f, -0.2f, -side * 0.5f + 0.2f, 0.2f, 8) ==
           MaskedOcclusionCulling::VISIBLE);
    engine.moc->RecorderStop();

    FrameRecording recording;
    EXPECT(FrameRecording::Load(RECORDING, recording));
    EXPECT(recording.mPlaybackOrder.size() == 4 && recording.mRectEntries.size() == 2);
    remove(RECORDING);

    {
        CullingThreadpool pool(2, 2, 2);
        pool.SetBuffer(engine.moc);
        pool.WakeThreads();
        pool.ClearBuffer();
        pool.RenderTriangles(wall, triangles, 2, MaskedOcclusionCulling::BACKFACE_NONE);
        pool.Flush();
        EXPECT(engine.moc->TestRect(side * 0.5f - 0.2f, -0.2f, side * 0.5f + 0.2f, 0.2f, 8) ==
               MaskedOcclusionCulling::OCCLUDED);
    }
    MaskedOcclusionCulling::Destroy(engine.moc);
    return 0;
}
