#include "app/bench/bench.h"
#include "app/commands/command.h"

#include <string.h>

// The first word is a benchmark of one part, or else the first scene or DEM that accuracy is measured over.
static const struct {
    const char *word;
    Result (*run)(const Options *options);
} PARTS[] = {
    {"preprocess", bench_preprocess}, {"refine", bench_refine}, {"partitions", bench_partitions},
    {"governor", bench_governor},     {"panel", bench_panel},
};

Result cmd_bench(const Options *options) {
    const char *word = options_positional_count(options) ? options_positionals(options)[0] : "";
    for (size_t i = 0; i < COUNT_OF(PARTS); i++)
        if (strcmp(word, PARTS[i].word) == 0)
            return PARTS[i].run(options);
    return bench_accuracy(options);
}
