// In place of sheet.c where girih-patterns is built without cairo.
#include "sheet.h"

#include "error.h"

girih_result girih_sheet_draw(const girih_sheet *sheet, const girih_catalogue *catalogue,
                              girih_sheet_format format, girih_progress *progress, FILE *stream,
                              girih_error *error) {
    (void)sheet;
    (void)catalogue;
    (void)format;
    (void)progress;
    (void)stream;
    return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                      "this girih-patterns was built without cairo, which draws sheets; install "
                      "libcairo2-dev, then "
                      "build it again");
}
