// A translation unit that asks for four layers, while the rest of its program has the quick rule.
#define QUICK_MASK 1
#define MOC_FOUR_LAYERS 1
#include "switches.h"
#include "switches_report.inl"

Report ReportFourLayer()
{
    return MakeReport();
}
