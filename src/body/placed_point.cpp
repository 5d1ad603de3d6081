// The compiled function bodies of placed_point-inl.h.
#include <pliant/body/placed_point-inl.h>
