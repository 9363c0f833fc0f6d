"use strict";
class PatrolScene { }
