// The same source in every translation unit, so that sharing an inline function between them would be detected.
#include "MaskedOcclusionCulling.h"
#include "check.h"

#include <vector>

static inline Report MakeReport()
{
    Report report = {-1, -1, false};
    MaskedOcclusionCulling *moc = MaskedOcclusionCulling::Create();
    CHECK(moc != nullptr);
    if (moc == nullptr)
        return report;
    CHECK_EQ(MOC_GetUpdateRule(moc, &report.update_rule), MOC_STATUS_OK);
    report.implementation = moc->GetImplementation();
    moc->SetResolution(64, 64);
    float quad[16];
    quad_at(quad, -2.0f, 0.0f, 2.0f, 2.0f, 10.0f); // the upper half of the view
    moc->RenderTriangles(quad, QUAD, 2);
    std::vector<float> depth(64 * 64);
    moc->ComputePixelDepthBuffer(depth.data(), false);
    CHECK((depth[0] >= 0.0f) != (depth[63 * 64] >= 0.0f));
    report.first_row_is_top = depth[0] >= 0.0f;
    MaskedOcclusionCulling::Destroy(moc);

    // The other overload carries the switches too.
    int32_t rule = -1;
    moc = MaskedOcclusionCulling::Create(MaskedOcclusionCulling::SSE2, nullptr, nullptr);
    CHECK_EQ(MOC_GetUpdateRule(moc, &rule), MOC_STATUS_OK);
    CHECK_EQ(rule, report.update_rule);
    MaskedOcclusionCulling::Destroy(moc);
    if (check_failures != 0)
        report.update_rule = -1;
    return report;
}
