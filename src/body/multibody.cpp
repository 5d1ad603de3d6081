// The compiled bodies of multibody-inl.h.
#include <pliant/body/multibody-inl.h>
