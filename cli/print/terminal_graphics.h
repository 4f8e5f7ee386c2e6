#pragma once

/// Which pictures the terminal can show, and showing one.

#include <string>

#include "cli/client/context.h"

namespace regrasp::cli {

enum class Graphics { kKitty, kSixel, kBlocks, kDots };

/// What the terminal says it can do, and the size of its cells.
struct TerminalAnswer {
  bool kitty = false, sixel = false;
  int cell_width = 0, cell_height = 0;  ///< [pixels]; 0: not told
  bool complete = false;                ///< the last expected answer has come
};
/// Reads the answers to the queries: kitty's, cell size (CSI 16 t), primary attributes (CSI c),
/// which every terminal answers and which comes last. `text` may be incomplete.
TerminalAnswer ReadAnswer(const std::string& text);

/// The picture file as text for standard output: as $REGRASP_GRAPHICS says (kitty, sixel, blocks,
/// dots), else as the terminal can, else blocks, or dots without colour. Throws CliError.
std::string DrawPicture(Context& context, const std::string& file);

}  // namespace regrasp::cli
