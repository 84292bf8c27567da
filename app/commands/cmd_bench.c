#include "app/bench/bench.h"
#include "app/commands/command.h"
#include "base/log.h"

#include <string.h>

Result cmd_bench(const Options *options) {
    const char *kind = options_positional_count(options) ? options_positionals(options)[0] : "";
    if (strcmp(kind, "preprocess") == 0)
        return bench_preprocess(options);
    if (strcmp(kind, "refine") == 0)
        return bench_refine(options);
    if (strcmp(kind, "partitions") == 0)
        return bench_partitions(options);
    if (strcmp(kind, "panel") == 0)
        return bench_panel(options);
    log_error("bench: expected 'preprocess', 'refine', 'partitions' or 'panel', found '%s'; for example: overfly bench "
              "refine "
              "--tau 1 --json",
              kind);
    return RESULT_USAGE;
}
