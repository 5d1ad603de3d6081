// The compiled bodies of advance-inl.h.
#include <pliant/body/advance-inl.h>
