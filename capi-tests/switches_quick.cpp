// A translation unit that asks for the quick rule and rows from the bottom.
#define QUICK_MASK 1
#define USE_D3D 0
#define PRECISE_COVERAGE 0
#define USE_AVX512 1
#define CLIPPING_PRESERVES_ORDER 0
#define ENABLE_STATS 1
#include "switches.h"
#include "switches_report.inl"

Report ReportQuick()
{
    return MakeReport();
}
