// The engine behind facade.c. With a prefix it defines a function with the name of one of the library's, in the same file that
// uses the class.
#include "CullingThreadpool.h"
#include "FrameRecorder.h"
#include "MaskedOcclusionCulling.h"

static MaskedOcclusionCulling *moc;

extern "C" int engine_create(void)
{
    moc = MaskedOcclusionCulling::Create();
    if (moc == nullptr)
        return 0;
    moc->SetResolution(128, 64);
    return 1;
}

extern "C" void engine_clear(void)
{
    moc->ClearBuffer();
}

extern "C" void engine_draw(void)
{
    const float wall[] = {-5, -5, 0, 5, 5, -5, 0, 5, 5, 5, 0, 5, -5, 5, 0, 5};
    const unsigned int triangles[] = {0, 1, 2, 0, 2, 3};
    moc->RenderTriangles(wall, triangles, 2);
}

extern "C" int engine_hides(void)
{
    return moc->TestRect(-0.5f, -0.5f, 0.5f, 0.5f, 8.0f) == MaskedOcclusionCulling::OCCLUDED;
}

extern "C" void engine_destroy(void)
{
    MaskedOcclusionCulling::Destroy(moc);
    moc = nullptr;
}

#ifdef MOC_SYMBOL_PREFIX
extern "C" int MOC_TestRect(void);

extern "C" int MOC_TestRect(void)
{
    return 1000 + engine_hides();
}
#endif
