// The quality of drafts follows the time of pictures.
#include <pliant/view/draft_quality.h>

#include <catch2/catch.hpp>

namespace draft_quality_test {
using namespace pliant;
using Quality = WindowRenderer::Quality;

/// Adds pictures whose time is proportional to the number of samples. full: time with one for each pixel, s.
/// Returns the number of changes.
int draw(DraftQuality& draft, double full, int pictures) {
  int changes = 0;
  for (int i = 0; i < pictures; ++i) {
    const Quality before = draft.quality();
    const double samples = WindowRenderer::samples(before);
    draft.add(full * samples * samples);
    if (draft.quality() != before) ++changes;
  }
  return changes;
}

TEST_CASE("drafts have fewer samples on a slow machine, and all again on a fast one") {
  DraftQuality draft;
  CHECK(draft.quality() == Quality::draft);
  CHECK(draw(draft, 0.9 * DraftQuality::kLongest, 100) == 0);
  CHECK(draw(draft, 1.1 * DraftQuality::kLongest, 100) == 1);
  CHECK(draft.quality() == Quality::two_thirds_draft);
  CHECK(draw(draft, 3 * DraftQuality::kLongest, 100) == 1);
  CHECK(draft.quality() == Quality::half_draft);
  CHECK(draw(draft, 100 * DraftQuality::kLongest, 100) == 0);
  CHECK(draw(draft, 0.5 * DraftQuality::kLongest, 100) == 2);
  CHECK(draft.quality() == Quality::draft);
}

TEST_CASE("one slow picture does not change the quality of drafts") {
  DraftQuality draft;
  draw(draft, 0.5 * DraftQuality::kLongest, 20);
  draft.add(2 * DraftQuality::kLongest);
  CHECK(draft.quality() == Quality::draft);
}

}  // namespace draft_quality_test
