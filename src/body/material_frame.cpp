// The compiled function bodies of material_frame-inl.h.
#include <pliant/body/material_frame-inl.h>
