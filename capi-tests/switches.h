// What each translation unit of the `switches` program reports about the object created with its switches.
#pragma once

#include <stdint.h>

struct Report
{
    int32_t update_rule;
    int32_t implementation;
    bool first_row_is_top;
};

Report ReportDefault();
Report ReportQuick();
Report ReportAccurate();
Report ReportFourLayer();
