// A translation unit that asks for the accurate rule and no AVX-512.
#define QUICK_MASK 0
#define USE_D3D 1
#define USE_AVX512 0
#define MOC_RECORDER_ENABLE 0
#define MOC_RECORDER_ENABLE_PLAYBACK 0
#include "switches.h"
#include "switches_report.inl"

Report ReportAccurate()
{
    return MakeReport();
}
