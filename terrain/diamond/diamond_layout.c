// Yalcin, Weiss, De Floriani 2011, section 3: the tiling of each level by super-squares. Our own: levels of any width,
// whose last super-squares are partial.
#include "terrain/diamond/diamond_layout.h"

DiamondLayout diamond_layout(int width, int height, int planes) {
    DiamondLayout layout = {.width = width, .height = height, .level_count = planes > 0 ? planes : 1};
    for (int k = 0; k < layout.level_count; k++) {
        uint32_t columns = ((uint32_t)(width - 1) >> k) + 1, rows = ((uint32_t)(height - 1) >> k) + 1;
        layout.offset[k] = layout.word_count;
        layout.across[k] = (columns + 3) / 4;
        layout.down[k] = (rows + 3) / 4;
        layout.word_count += layout.across[k] * layout.down[k];
        layout.row_offset[k] = layout.row_count;
        layout.row_count += rows;
    }
    return layout;
}
