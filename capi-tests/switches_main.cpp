// Translation units with different switches in one program: each gets the settings that it requested.
#include "switches.h"
#include "switches_report.inl"

#ifdef QUICK_MASK
#error "the header must leave QUICK_MASK alone"
#endif
#ifdef USE_AVX512
#error "the header must leave USE_AVX512 alone"
#endif
#if USE_D3D != 1 || PRECISE_COVERAGE != 1 || CLIPPING_PRESERVES_ORDER != 1 || ENABLE_STATS != 0 || MOC_RECORDER_ENABLE != 0 || \
    MOC_FOUR_LAYERS != 0
#error "the other switches have the defaults that programs know"
#endif

Report ReportDefault()
{
    return MakeReport();
}

int main()
{
    const Report standard = ReportDefault(), quick = ReportQuick(), accurate = ReportAccurate();
    const Report four_layer = ReportFourLayer();
    CHECK_EQ(standard.update_rule, MOC_UPDATE_RULE_THREE_LAYER);
    CHECK_EQ(quick.update_rule, MOC_UPDATE_RULE_QUICK);
    CHECK_EQ(accurate.update_rule, MOC_UPDATE_RULE_ACCURATE);
    CHECK_EQ(four_layer.update_rule, MOC_UPDATE_RULE_FOUR_LAYER);
    CHECK(standard.first_row_is_top);
    CHECK(!quick.first_row_is_top);
    CHECK(accurate.first_row_is_top);
    CHECK(four_layer.first_row_is_top);
    CHECK_EQ(standard.implementation, quick.implementation);
    CHECK(accurate.implementation != MOC_AVX512);
    if (standard.implementation == MOC_AVX512)
        CHECK_EQ(accurate.implementation, MOC_AVX2);
    else
        CHECK_EQ(accurate.implementation, standard.implementation);
    return check_report("switches");
}
