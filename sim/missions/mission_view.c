#include "sim/missions/mission_view.h"

bool mission_view_wants_rows(const struct mission_view *view)
{
    return view->log != NULL || view->record != NULL;
}

void mission_view_row(const struct mission_view *view, const struct scenario *scenario, const struct mission_row *row)
{
    if (view->log != NULL) {
        mission_log_row(view->log, scenario, row);
    }
    if (view->record != NULL) {
        view->record(view->context, row);
    }
}
