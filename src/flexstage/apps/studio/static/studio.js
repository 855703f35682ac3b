"use strict";(()=>{function S(s,e={},...t){let i=document.createElement(s);for(let[n,r]of Object.entries(e))l_(i,n,r);return i.append(...t.filter(n=>n!=null&&n!==!1)),i}function l_(s,e,t){t==null||t===!1||(typeof t=="function"?s.addEventListener(e,t):e in s&&e!=="list"&&e!=="form"?s[e]=t:s.setAttribute(e,t===!0?"":String(t)))}function re(s){let e=document.getElementById(s);if(e===null)throw new Error(`The page has no element ${s}.`);return e}function K(s,...e){s.replaceChildren(...e.filter(t=>t!=null&&t!==!1))}function we(s,e=5){if(s==null||Number.isNaN(s))return"–";if(!Number.isFinite(s))return s>0?"∞":"−∞";let t=Math.abs(s);return(t!==0&&(t>=1e6||t<1e-4)?c_(s.toExponential(e-1)):String(Number(s.toPrecision(e)))).replace("-","−")}function c_(s){return s.replace(/\.?0*e/,"e").replace("e+","e")}function ht(s,e,t=5){if(s==null)return"–";let i=we(s/e.factor,t);return e.unit&&e.unit!=="1"?`${i} ${e.unit}`:i}function lo(s,e){return s===null||e===null||e===0?"":ei(s/e-1)}function ei(s,e=3){if(s===null||!Number.isFinite(s)||Math.abs(s)<5e-6)return"";let t=`${we(100*s,e)} %`;return s>0?`+${t}`:t}function sr(s,e,t=""){return S("table",{className:t},S("thead",{},S("tr",{},...s.map(i=>S("th",{scope:"col"},i)))),S("tbody",{},...e.map(i=>S("tr",{},...i.map((n,r)=>S(r===0?"th":"td",r===0?{scope:"row"}:{},n))))))}function Sa(s){let e=!1;return()=>{e||(e=!0,requestAnimationFrame(()=>{e=!1,s()}))}}function co(s,e){let t,i=()=>{t=void 0,e()};return Object.assign(()=>{clearTimeout(t),t=setTimeout(i,s)},{now:()=>t===void 0?!1:(clearTimeout(t),i(),!0)})}function rr(s,e){let t=new Map;for(let i of s){let n=e(i),r=t.get(n);r?r.push(i):t.set(n,[i])}return t}var wa=class{constructor(e){this.studio=e;e.tab.watch(t=>t==="build"&&this.ask()),e.state.watch(()=>e.tab.value==="build"&&this.ask())}studio;root=re("pane-build");ask(){this.root.contains(document.activeElement)&&document.activeElement?.tagName==="INPUT"||this.studio.connection.newest("palette",{kind:"palette"},e=>e.kind==="snippets"&&this.show(e.snippets))}show(e){let t=new Set([...this.root.querySelectorAll("details[open]")].map(n=>n.getAttribute("data-name"))),i=[...rr(e,n=>n.group)].flatMap(([n,r])=>[S("h4",{},n),...r.map(o=>this.snippet(o,t.has(o.name)))]);K(this.root,S("p",{className:"quiet"},"Inserted text goes to where the file keeps its kind; what it says can be changed there."),...i)}snippet(e,t){let i=Object.entries(e.fields).map(([a,l])=>({name:a,input:S("input",{type:"text",value:l,spellcheck:!1,ariaLabel:a})})),n=()=>{this.insert(e,Object.fromEntries(i.map(({name:a,input:l})=>[a,l.value])))},r=i.map(({name:a,input:l})=>S("label",{},a,l)),o=S("details",{open:t},S("summary",{},e.title),S("form",{className:"snippet",submit:a=>(a.preventDefault(),n())},...r,S("button",{type:"submit"},"insert")));return o.dataset.name=e.name,o}async insert(e,t){let i=this.studio.state.value?.text??"";(await this.studio.ask({kind:"insert",snippet:e.name,fields:t})).kind!=="refusal"&&this.studio.goto(h_(i,this.studio.state.value?.text??""),!1)}};function h_(s,e){let t=s.split(`
`);return e.split(`
`).findIndex((n,r)=>n!==t[r])+1}var rt=class{constructor(e){this.held=e}held;watchers=new Set;get value(){return this.held}set(e){let t=this.held;if(this.held=e,e!==t)for(let i of this.watchers)i(e,t)}watch(e){return this.watchers.add(e),()=>this.watchers.delete(e)}};var f_=1500,d_=4e3;function p_(){let s=location.hash.replace(/^#(token=)?/,"");return s&&(sessionStorage.setItem("token",s),history.replaceState(null,"",location.pathname+location.search)),s||(sessionStorage.getItem("token")??"")}var Ma=class{state=new rt("opens");count={sent:0,received:0,characters:0};socket=null;token=p_();acts=new Map;waiting=new Map;lanes=new Map;last=0;on(e,t){this.acts.set(e,[...this.acts.get(e)??[],t])}open(){let e=new WebSocket(`${location.protocol==="https:"?"wss":"ws"}://${location.host}/socket`);this.socket=e,e.addEventListener("open",()=>e.send(JSON.stringify({kind:"hello",token:this.token,version:1}))),e.addEventListener("message",t=>this.hear(t.data)),e.addEventListener("close",t=>this.lose(t.code))}lose(e){this.state.set(e>=d_||e===1008?"refused":"lost");for(let t of this.waiting.values())t({kind:"refusal",to:0,problems:[],stale:!1});this.waiting.clear(),this.state.value==="lost"&&setTimeout(()=>this.open(),f_)}hear(e){let t=JSON.parse(e);this.count.received+=1,this.count.characters+=e.length,t.kind==="welcome"&&this.state.set("open");for(let i of this.acts.get(t.kind)??[])i(t);"to"in t&&(this.waiting.get(t.to)?.(t),this.waiting.delete(t.to))}ask(e){let t=++this.last;return this.socket?.readyState!==WebSocket.OPEN?Promise.resolve({kind:"refusal",to:t,problems:[],stale:!1}):(this.count.sent+=1,this.socket.send(JSON.stringify({...e,id:t})),new Promise(i=>this.waiting.set(t,i)))}newest(e,t,i=()=>{}){let n=this.lanes.get(e)??{busy:!1,next:null};this.lanes.set(e,n),n.next=async()=>i(await this.ask(t)),n.busy||this.drain(n)}drop(e){let t=this.lanes.get(e);t&&(t.next=null)}async drain(e){for(e.busy=!0;e.next;){let t=e.next;e.next=null,await t()}e.busy=!1}};var Th=[],sm=[];(()=>{let s="lc,34,7n,7,7b,19,,,,2,,2,,,20,b,1c,l,g,,2t,7,2,6,2,2,,4,z,,u,r,2j,b,1m,9,9,,o,4,,9,,3,,5,17,3,1n,9,16,o,,x,1i,3,,i,,7,a,2,t,3,1k,,,7,2,2,2,3,9,,a,2,q,,2,3,1k,,,5,4,2,2,3,3,,u,2,3,,b,3,1k,,,8,,3,,3,k,2,m,6,,3,1k,,,7,2,2,2,3,7,3,a,2,u,,1n,5,3,3,,4,9,,14,5,1j,,,7,,3,,4,7,2,b,2,t,3,1k,,,7,,3,,4,7,2,b,2,f,,c,4,1j,2,,7,,3,,4,9,,a,2,t,3,1y,,4,6,,,,8,i,2,1p,,,8,c,8,2q,,,a,b,7,21,2,r,,,,,,4,2,1d,k,,2,5,b,,10,9,,2u,b,,6,n,4,4,3,g,4,d,,,3,6,,f,,jj,3,qa,4,s,3,t,2,u,2,1s,w,9,,19,3,,,39,2,y,,3a,c,4,c,63,5,1l,a,,,,,2,o,2,,1c,1a,2,c,k,5,1b,h,12,9,c,3,u,d,1k,e,1c,k,48,3,,l,4,,6,,2,3,5i,1s,ek,,5f,x,2da,3,3x,,2o,w,fe,6,2x,2,n9w,4,,a,w,2,28,2,7k,,3,,4,,n,5,4,,2b,2,1e,i,q,i,d,,12,8,p,d,18,4,1b,e,10,,1v,e,c,,8,2,1a,,1f,,,3,2,2,5,2,,,15,5,5,2,6k,8,,2,fn4,,kh,g,g,g,a6,2,gt,,6a,,45,5,1ae,3,,2,5,4,14,3,4,,4l,2,fx,4,1t,5,8t,2,25,6,1y,b,1d,4,3e,3,1h,f,15,,2,2,a,4,19,b,7,,1p,3,10,e,g,2,18,,c,3,1c,e,8,4,,2,2k,c,6,,2,,4d,c,l,4,1j,2,,7,2,2,2,3,9,,a,2,2,7,3,5,1v,9,,,2,,,4,,5,,,e,2,2a,i,n,,29,k,6j,7,2,9,r,2,2a,h,2y,d,2t,3,2,a,74,f,6t,6,,2,2,4,,,,2,3x,7,2,7,3,,s,a,14,7,,4,8,,9,b,1a,g,5i,8,5j,8,,8,2a,m,,e,3e,6,3,,,2,,7,,,1u,5,,2,,5,9n,4,9,2,,,1c,7,3,5,n,,44l,,6,f,8ug,i,1xc,5,1n,7,t4,,,1j,7,4,29,,b,2,f57,2,3mp,1a,2,n,f2,5,3,6,8,8,2,7,u,4,44,3,1iz,1j,4,1e,8,,e,,m,5,,f,11s,7,,h,2,7,,2,,5,2s,,4g,7,af,,1p,4,e4,4,72,2,6r,,2,,7,2,5,,d6,7,31,7,240,5".split(",").map(e=>e?parseInt(e,36):1);for(let e=0,t=0;e<s.length;e++)(e%2?sm:Th).push(t=t+s[e])})();function m_(s){if(s<768)return!1;for(let e=0,t=Th.length;;){let i=e+t>>1;if(s<Th[i])t=i;else if(s>=sm[i])e=i+1;else return!0;if(e==t)return!1}}function tm(s){return s>=127462&&s<=127487}var im=8205;function rm(s,e,t=!0,i=!0){return(t?om:g_)(s,e,i)}function om(s,e,t){if(e==s.length)return e;e&&am(s.charCodeAt(e))&&lm(s.charCodeAt(e-1))&&e--;let i=Ah(s,e);for(e+=nm(i);e<s.length;){let n=Ah(s,e);if(i==im||n==im||t&&m_(n))e+=nm(n),i=n;else if(tm(n)){let r=0,o=e-2;for(;o>=0&&tm(Ah(s,o));)r++,o-=2;if(r%2==0)break;e+=2}else break}return e}function g_(s,e,t){for(;e>1;){let i=om(s,e-2,t);if(i<e)return i;e--}return 0}function Ah(s,e){let t=s.charCodeAt(e);if(!lm(t)||e+1==s.length)return t;let i=s.charCodeAt(e+1);return am(i)?(t-55296<<10)+(i-56320)+65536:t}function am(s){return s>=56320&&s<57344}function lm(s){return s>=55296&&s<56320}function nm(s){return s<65536?1:2}var be=class s{lineAt(e){if(e<0||e>this.length)throw new RangeError(`Invalid position ${e} in document of length ${this.length}`);return this.lineInner(e,!1,1,0)}line(e){if(e<1||e>this.lines)throw new RangeError(`Invalid line number ${e} in ${this.lines}-line document`);return this.lineInner(e,!0,1,0)}replace(e,t,i){[e,t]=hr(this,e,t);let n=[];return this.decompose(0,e,n,2),i.length&&i.decompose(0,i.length,n,3),this.decompose(t,this.length,n,1),ar.from(n,this.length-(t-e)+i.length)}append(e){return this.replace(this.length,this.length,e)}slice(e,t=this.length){[e,t]=hr(this,e,t);let i=[];return this.decompose(e,t,i,0),ar.from(i,t-e)}eq(e){if(e==this)return!0;if(e.length!=this.length||e.lines!=this.lines)return!1;let t=this.scanIdentical(e,1),i=this.length-this.scanIdentical(e,-1),n=new fs(this),r=new fs(e);for(let o=t,a=t;;){if(n.next(o),r.next(o),o=0,n.lineBreak!=r.lineBreak||n.done!=r.done||n.value!=r.value)return!1;if(a+=n.value.length,n.done||a>=i)return!0}}iter(e=1){return new fs(this,e)}iterRange(e,t=this.length){return new Ra(this,e,t)}iterLines(e,t){let i;if(e==null)i=this.iter();else{t==null&&(t=this.lines+1);let n=this.line(e).from;i=this.iterRange(n,Math.max(n,t==this.lines+1?this.length:t<=1?0:this.line(t-1).to))}return new Pa(i)}toString(){return this.sliceString(0)}toJSON(){let e=[];return this.flatten(e),e}constructor(){}static of(e){if(e.length==0)throw new RangeError("A document must have at least one line");return e.length==1&&!e[0]?s.empty:e.length<=32?new ti(e):ar.from(ti.split(e,[]))}},ti=class s extends be{constructor(e,t=x_(e)){super(),this.text=e,this.length=t}get lines(){return this.text.length}get children(){return null}lineInner(e,t,i,n){for(let r=0;;r++){let o=this.text[r],a=n+o.length;if((t?i:a)>=e)return new Ch(n,a,i,o);n=a+1,i++}}decompose(e,t,i,n){let r=e<=0&&t>=this.length?this:new s(cm(this.text,e,t),Math.min(t,this.length)-Math.max(0,e));if(n&1){let o=i.pop(),a=Ca(r.text,o.text.slice(),0,r.length);if(a.length<=32)i.push(new s(a,o.length+r.length));else{let l=a.length>>1;i.push(new s(a.slice(0,l)),new s(a.slice(l)))}}else i.push(r)}replace(e,t,i){if(!(i instanceof s))return super.replace(e,t,i);[e,t]=hr(this,e,t);let n=Ca(this.text,Ca(i.text,cm(this.text,0,e)),t),r=this.length+i.length-(t-e);return n.length<=32?new s(n,r):ar.from(s.split(n,[]),r)}sliceString(e,t=this.length,i=`
`){[e,t]=hr(this,e,t);let n="";for(let r=0,o=0;r<=t&&o<this.text.length;o++){let a=this.text[o],l=r+a.length;r>e&&o&&(n+=i),e<l&&t>r&&(n+=a.slice(Math.max(0,e-r),t-r)),r=l+1}return n}flatten(e){for(let t of this.text)e.push(t)}scanIdentical(){return 0}static split(e,t){let i=[],n=-1;for(let r of e)i.push(r),n+=r.length+1,i.length==32&&(t.push(new s(i,n)),i=[],n=-1);return n>-1&&t.push(new s(i,n)),t}},ar=class s extends be{constructor(e,t){super(),this.children=e,this.length=t,this.lines=0;for(let i of e)this.lines+=i.lines}lineInner(e,t,i,n){for(let r=0;;r++){let o=this.children[r],a=n+o.length,l=i+o.lines-1;if((t?l:a)>=e)return o.lineInner(e,t,i,n);n=a+1,i=l+1}}decompose(e,t,i,n){for(let r=0,o=0;o<=t&&r<this.children.length;r++){let a=this.children[r],l=o+a.length;if(e<=l&&t>=o){let c=n&((o<=e?1:0)|(l>=t?2:0));o>=e&&l<=t&&!c?i.push(a):a.decompose(e-o,t-o,i,c)}o=l+1}}replace(e,t,i){if([e,t]=hr(this,e,t),i.lines<this.lines)for(let n=0,r=0;n<this.children.length;n++){let o=this.children[n],a=r+o.length;if(e>=r&&t<=a){let l=o.replace(e-r,t-r,i),c=this.lines-o.lines+l.lines;if(l.lines<c>>4&&l.lines>c>>6){let h=this.children.slice();return h[n]=l,new s(h,this.length-(t-e)+i.length)}return super.replace(r,a,l)}r=a+1}return super.replace(e,t,i)}sliceString(e,t=this.length,i=`
`){[e,t]=hr(this,e,t);let n="";for(let r=0,o=0;r<this.children.length&&o<=t;r++){let a=this.children[r],l=o+a.length;o>e&&r&&(n+=i),e<l&&t>o&&(n+=a.sliceString(e-o,t-o,i)),o=l+1}return n}flatten(e){for(let t of this.children)t.flatten(e)}scanIdentical(e,t){if(!(e instanceof s))return 0;let i=0,[n,r,o,a]=t>0?[0,0,this.children.length,e.children.length]:[this.children.length-1,e.children.length-1,-1,-1];for(;;n+=t,r+=t){if(n==o||r==a)return i;let l=this.children[n],c=e.children[r];if(l!=c)return i+l.scanIdentical(c,t);i+=l.length+1}}static from(e,t=e.reduce((i,n)=>i+n.length+1,-1)){let i=0;for(let d of e)i+=d.lines;if(i<32){let d=[];for(let m of e)m.flatten(d);return new ti(d,t)}let n=Math.max(32,i>>5),r=n<<1,o=n>>1,a=[],l=0,c=-1,h=[];function u(d){let m;if(d.lines>r&&d instanceof s)for(let g of d.children)u(g);else d.lines>o&&(l>o||!l)?(f(),a.push(d)):d instanceof ti&&l&&(m=h[h.length-1])instanceof ti&&d.lines+m.lines<=32?(l+=d.lines,c+=d.length+1,h[h.length-1]=new ti(m.text.concat(d.text),m.length+1+d.length)):(l+d.lines>n&&f(),l+=d.lines,c+=d.length+1,h.push(d))}function f(){l!=0&&(a.push(h.length==1?h[0]:s.from(h,c)),c=-1,l=h.length=0)}for(let d of e)u(d);return f(),a.length==1?a[0]:new s(a,t)}};be.empty=new ti([""],0);function x_(s){let e=-1;for(let t of s)e+=t.length+1;return e}function Ca(s,e,t=0,i=1e9){for(let n=0,r=0,o=!0;r<s.length&&n<=i;r++){let a=s[r],l=n+a.length;l>=t&&(l>i&&(a=a.slice(0,i-n)),n<t&&(a=a.slice(t-n)),o?(e[e.length-1]+=a,o=!1):e.push(a)),n=l+1}return e}function cm(s,e,t){return Ca(s,[""],e,t)}var fs=class{constructor(e,t=1){this.dir=t,this.done=!1,this.lineBreak=!1,this.value="",this.nodes=[e],this.offsets=[t>0?1:(e instanceof ti?e.text.length:e.children.length)<<1]}nextInner(e,t){for(this.done=this.lineBreak=!1;;){let i=this.nodes.length-1,n=this.nodes[i],r=this.offsets[i],o=r>>1,a=n instanceof ti?n.text.length:n.children.length;if(o==(t>0?a:0)){if(i==0)return this.done=!0,this.value="",this;t>0&&this.offsets[i-1]++,this.nodes.pop(),this.offsets.pop()}else if((r&1)==(t>0?0:1)){if(this.offsets[i]+=t,e==0)return this.lineBreak=!0,this.value=`
`,this;e--}else if(n instanceof ti){let l=n.text[o+(t<0?-1:0)];if(this.offsets[i]+=t,l.length>Math.max(0,e))return this.value=e==0?l:t>0?l.slice(e):l.slice(0,l.length-e),this;e-=l.length}else{let l=n.children[o+(t<0?-1:0)];e>l.length?(e-=l.length,this.offsets[i]+=t):(t<0&&this.offsets[i]--,this.nodes.push(l),this.offsets.push(t>0?1:(l instanceof ti?l.text.length:l.children.length)<<1))}}}next(e=0){return e<0&&(this.nextInner(-e,-this.dir),e=this.value.length),this.nextInner(e,this.dir)}},Ra=class{constructor(e,t,i){this.value="",this.done=!1,this.cursor=new fs(e,t>i?-1:1),this.pos=t>i?e.length:0,this.from=Math.min(t,i),this.to=Math.max(t,i)}nextInner(e,t){if(t<0?this.pos<=this.from:this.pos>=this.to)return this.value="",this.done=!0,this;e+=Math.max(0,t<0?this.pos-this.to:this.from-this.pos);let i=t<0?this.pos-this.from:this.to-this.pos;e>i&&(e=i),i-=e;let{value:n}=this.cursor.next(e);return this.pos+=(n.length+e)*t,this.value=n.length<=i?n:t<0?n.slice(n.length-i):n.slice(0,i),this.done=!this.value,this}next(e=0){return e<0?e=Math.max(e,this.from-this.pos):e>0&&(e=Math.min(e,this.to-this.pos)),this.nextInner(e,this.cursor.dir)}get lineBreak(){return this.cursor.lineBreak&&this.value!=""}},Pa=class{constructor(e){this.inner=e,this.afterBreak=!0,this.value="",this.done=!1}next(e=0){let{done:t,lineBreak:i,value:n}=this.inner.next(e);return t&&this.afterBreak?(this.value="",this.afterBreak=!1):t?(this.done=!0,this.value=""):i?this.afterBreak?this.value="":(this.afterBreak=!0,this.next()):(this.value=n,this.afterBreak=!1),this}get lineBreak(){return!1}};typeof Symbol<"u"&&(be.prototype[Symbol.iterator]=function(){return this.iter()},fs.prototype[Symbol.iterator]=Ra.prototype[Symbol.iterator]=Pa.prototype[Symbol.iterator]=function(){return this});var Ch=class{constructor(e,t,i,n){this.from=e,this.to=t,this.number=i,this.text=n}get length(){return this.to-this.from}};function hr(s,e,t){return e=Math.max(0,Math.min(s.length,e)),[e,Math.max(e,Math.min(s.length,t))]}function nt(s,e,t=!0,i=!0){return rm(s,e,t,i)}function v_(s){return s>=56320&&s<57344}function y_(s){return s>=55296&&s<56320}function Oa(s,e){let t=s.charCodeAt(e);if(!y_(t)||e+1==s.length)return t;let i=s.charCodeAt(e+1);return v_(i)?(t-55296<<10)+(i-56320)+65536:t}function pm(s){return s<=65535?String.fromCharCode(s):(s-=65536,String.fromCharCode((s>>10)+55296,(s&1023)+56320))}function Fa(s){return s<65536?1:2}var Rh=/\r\n?|\n/,Bt=(function(s){return s[s.Simple=0]="Simple",s[s.TrackDel=1]="TrackDel",s[s.TrackBefore=2]="TrackBefore",s[s.TrackAfter=3]="TrackAfter",s})(Bt||(Bt={})),mn=class s{constructor(e){this.sections=e}get length(){let e=0;for(let t=0;t<this.sections.length;t+=2)e+=this.sections[t];return e}get newLength(){let e=0;for(let t=0;t<this.sections.length;t+=2){let i=this.sections[t+1];e+=i<0?this.sections[t]:i}return e}get empty(){return this.sections.length==0||this.sections.length==2&&this.sections[1]<0}iterGaps(e){for(let t=0,i=0,n=0;t<this.sections.length;){let r=this.sections[t++],o=this.sections[t++];o<0?(e(i,n,r),n+=r):n+=o,i+=r}}iterChangedRanges(e,t=!1){Ph(this,e,t)}get invertedDesc(){let e=[];for(let t=0;t<this.sections.length;){let i=this.sections[t++],n=this.sections[t++];n<0?e.push(i,n):e.push(n,i)}return new s(e)}composeDesc(e){return this.empty?e:e.empty?this:mm(this,e)}mapDesc(e,t=!1){return e.empty?this:kh(this,e,t)}mapPos(e,t=-1,i=Bt.Simple){let n=0,r=0;for(let o=0;o<this.sections.length;){let a=this.sections[o++],l=this.sections[o++],c=n+a;if(l<0){if(c>e)return r+(e-n);r+=a}else{if(i!=Bt.Simple&&c>=e&&(i==Bt.TrackDel&&n<e&&c>e||i==Bt.TrackBefore&&n<e||i==Bt.TrackAfter&&c>e))return null;if(c>e||c==e&&t<0&&!a)return e==n||t<0?r:r+l;r+=l}n=c}if(e>n)throw new RangeError(`Position ${e} is out of range for changeset of length ${n}`);return r}touchesRange(e,t=e){for(let i=0,n=0;i<this.sections.length&&n<=t;){let r=this.sections[i++],o=this.sections[i++],a=n+r;if(o>=0&&n<=t&&a>=e)return n<e&&a>t?"cover":!0;n=a}return!1}toString(){let e="";for(let t=0;t<this.sections.length;){let i=this.sections[t++],n=this.sections[t++];e+=(e?" ":"")+i+(n>=0?":"+n:"")}return e}toJSON(){return this.sections}static fromJSON(e){if(!Array.isArray(e)||e.length%2||e.some(t=>typeof t!="number"))throw new RangeError("Invalid JSON representation of ChangeDesc");return new s(e)}static create(e){return new s(e)}},Ut=class s extends mn{constructor(e,t){super(e),this.inserted=t}apply(e){if(this.length!=e.length)throw new RangeError("Applying change set to a document with the wrong length");return Ph(this,(t,i,n,r,o)=>e=e.replace(n,n+(i-t),o),!1),e}mapDesc(e,t=!1){return kh(this,e,t,!0)}invert(e){let t=this.sections.slice(),i=[];for(let n=0,r=0;n<t.length;n+=2){let o=t[n],a=t[n+1];if(a>=0){t[n]=a,t[n+1]=o;let l=n>>1;for(;i.length<l;)i.push(be.empty);i.push(o?e.slice(r,r+o):be.empty)}r+=o}return new s(t,i)}compose(e){return this.empty?e:e.empty?this:mm(this,e,!0)}map(e,t=!1){return e.empty?this:kh(this,e,t,!0)}iterChanges(e,t=!1){Ph(this,e,t)}get desc(){return mn.create(this.sections)}filter(e){let t=[],i=[],n=[],r=new ds(this);e:for(let o=0,a=0;;){let l=o==e.length?1e9:e[o++];for(;a<l||a==l&&r.len==0;){if(r.done)break e;let h=Math.min(r.len,l-a);Rt(n,h,-1);let u=r.ins==-1?-1:r.off==0?r.ins:0;Rt(t,h,u),u>0&&In(i,t,r.text),r.forward(h),a+=h}let c=e[o++];for(;a<c;){if(r.done)break e;let h=Math.min(r.len,c-a);Rt(t,h,-1),Rt(n,h,r.ins==-1?-1:r.off==0?r.ins:0),r.forward(h),a+=h}}return{changes:new s(t,i),filtered:mn.create(n)}}toJSON(){let e=[];for(let t=0;t<this.sections.length;t+=2){let i=this.sections[t],n=this.sections[t+1];n<0?e.push(i):n==0?e.push([i]):e.push([i].concat(this.inserted[t>>1].toJSON()))}return e}static of(e,t,i){let n=[],r=[],o=0,a=null;function l(h=!1){if(!h&&!n.length)return;o<t&&Rt(n,t-o,-1);let u=new s(n,r);a=a?a.compose(u.map(a)):u,n=[],r=[],o=0}function c(h){if(Array.isArray(h))for(let u of h)c(u);else if(h instanceof s){if(h.length!=t)throw new RangeError(`Mismatched change set length (got ${h.length}, expected ${t})`);l(),a=a?a.compose(h.map(a)):h}else{let{from:u,to:f=u,insert:d}=h;if(u>f||u<0||f>t)throw new RangeError(`Invalid change range ${u} to ${f} (in doc of length ${t})`);let m=d?typeof d=="string"?be.of(d.split(i||Rh)):d:be.empty,g=m.length;if(u==f&&g==0)return;u<o&&l(),u>o&&Rt(n,u-o,-1),Rt(n,f-u,g),In(r,n,m),o=f}}return c(e),l(!a),a}static empty(e){return new s(e?[e,-1]:[],[])}static fromJSON(e){if(!Array.isArray(e))throw new RangeError("Invalid JSON representation of ChangeSet");let t=[],i=[];for(let n=0;n<e.length;n++){let r=e[n];if(typeof r=="number")t.push(r,-1);else{if(!Array.isArray(r)||typeof r[0]!="number"||r.some((o,a)=>a&&typeof o!="string"))throw new RangeError("Invalid JSON representation of ChangeSet");if(r.length==1)t.push(r[0],0);else{for(;i.length<n;)i.push(be.empty);i[n]=be.of(r.slice(1)),t.push(r[0],i[n].length)}}}return new s(t,i)}static createSet(e,t){return new s(e,t)}};function Rt(s,e,t,i=!1){if(e==0&&t<=0)return;let n=s.length-2;n>=0&&t<=0&&t==s[n+1]?s[n]+=e:n>=0&&e==0&&s[n]==0?s[n+1]+=t:i?(s[n]+=e,s[n+1]+=t):s.push(e,t)}function In(s,e,t){if(t.length==0)return;let i=e.length-2>>1;if(i<s.length)s[s.length-1]=s[s.length-1].append(t);else{for(;s.length<i;)s.push(be.empty);s.push(t)}}function Ph(s,e,t){let i=s.inserted;for(let n=0,r=0,o=0;o<s.sections.length;){let a=s.sections[o++],l=s.sections[o++];if(l<0)n+=a,r+=a;else{let c=n,h=r,u=be.empty;for(;c+=a,h+=l,l&&i&&(u=u.append(i[o-2>>1])),!(t||o==s.sections.length||s.sections[o+1]<0);)a=s.sections[o++],l=s.sections[o++];e(n,c,r,h,u),n=c,r=h}}}function kh(s,e,t,i=!1){let n=[],r=i?[]:null,o=new ds(s),a=new ds(e);for(let l=-1;;){if(o.done&&a.len||a.done&&o.len)throw new Error("Mismatched change set lengths");if(o.ins==-1&&a.ins==-1){let c=Math.min(o.len,a.len);Rt(n,c,-1),o.forward(c),a.forward(c)}else if(a.ins>=0&&(o.ins<0||l==o.i||o.off==0&&(a.len<o.len||a.len==o.len&&!t))){let c=a.len;for(Rt(n,a.ins,-1);c;){let h=Math.min(o.len,c);o.ins>=0&&l<o.i&&o.len<=h&&(Rt(n,0,o.ins),r&&In(r,n,o.text),l=o.i),o.forward(h),c-=h}a.next()}else if(o.ins>=0){let c=0,h=o.len;for(;h;)if(a.ins==-1){let u=Math.min(h,a.len);c+=u,h-=u,a.forward(u)}else if(a.ins==0&&a.len<h)h-=a.len,a.next();else break;Rt(n,c,l<o.i?o.ins:0),r&&l<o.i&&In(r,n,o.text),l=o.i,o.forward(o.len-h)}else{if(o.done&&a.done)return r?Ut.createSet(n,r):mn.create(n);throw new Error("Mismatched change set lengths")}}}function mm(s,e,t=!1){let i=[],n=t?[]:null,r=new ds(s),o=new ds(e);for(let a=!1;;){if(r.done&&o.done)return n?Ut.createSet(i,n):mn.create(i);if(r.ins==0)Rt(i,r.len,0,a),r.next();else if(o.len==0&&!o.done)Rt(i,0,o.ins,a),n&&In(n,i,o.text),o.next();else{if(r.done||o.done)throw new Error("Mismatched change set lengths");{let l=Math.min(r.len2,o.len),c=i.length;if(r.ins==-1){let h=o.ins==-1?-1:o.off?0:o.ins;Rt(i,l,h,a),n&&h&&In(n,i,o.text)}else o.ins==-1?(Rt(i,r.off?0:r.len,l,a),n&&In(n,i,r.textBit(l))):(Rt(i,r.off?0:r.len,o.off?0:o.ins,a),n&&!o.off&&In(n,i,o.text));a=(r.ins>l||o.ins>=0&&o.len>l)&&(a||i.length>c),r.forward2(l),o.forward(l)}}}}var ds=class{constructor(e){this.set=e,this.i=0,this.next()}next(){let{sections:e}=this.set;this.i<e.length?(this.len=e[this.i++],this.ins=e[this.i++]):(this.len=0,this.ins=-2),this.off=0}get done(){return this.ins==-2}get len2(){return this.ins<0?this.len:this.ins}get text(){let{inserted:e}=this.set,t=this.i-2>>1;return t>=e.length?be.empty:e[t]}textBit(e){let{inserted:t}=this.set,i=this.i-2>>1;return i>=t.length&&!e?be.empty:t[i].slice(this.off,e==null?void 0:this.off+e)}forward(e){e==this.len?this.next():(this.len-=e,this.off+=e)}forward2(e){this.ins==-1?this.forward(e):e==this.ins?this.next():(this.ins-=e,this.off+=e)}},cs=class s{constructor(e,t,i,n){this.from=e,this.to=t,this.flags=i,this.goalColumn=n}get anchor(){return this.flags&32?this.to:this.from}get head(){return this.flags&32?this.from:this.to}get empty(){return this.from==this.to}get assoc(){return this.flags&8?-1:this.flags&16?1:0}get undirectional(){return(this.flags&64)>0}get bidiLevel(){let e=this.flags&7;return e==7?null:e}map(e,t=-1){let i,n;return this.empty?i=n=e.mapPos(this.from,t):(i=e.mapPos(this.from,1),n=e.mapPos(this.to,-1)),i==this.from&&n==this.to?this:new s(i,n,this.flags,this.goalColumn)}extend(e,t=e,i=0){if(e<=this.anchor&&t>=this.anchor)return I.range(e,t,void 0,void 0,i);let n=Math.abs(e-this.anchor)>Math.abs(t-this.anchor)?e:t;return I.range(this.anchor,n,void 0,void 0,i)}eq(e,t=!1){return this.anchor==e.anchor&&this.head==e.head&&this.goalColumn==e.goalColumn&&(!t||!this.empty||this.assoc==e.assoc)}toJSON(){return{anchor:this.anchor,head:this.head}}static fromJSON(e){if(!e||typeof e.anchor!="number"||typeof e.head!="number")throw new RangeError("Invalid JSON representation for SelectionRange");return I.range(e.anchor,e.head)}static create(e,t,i,n){return new s(e,t,i,n)}},I=class s{constructor(e,t){this.ranges=e,this.mainIndex=t}map(e,t=-1){return e.empty?this:s.create(this.ranges.map(i=>i.map(e,t)),this.mainIndex)}eq(e,t=!1){if(this.ranges.length!=e.ranges.length||this.mainIndex!=e.mainIndex)return!1;for(let i=0;i<this.ranges.length;i++)if(!this.ranges[i].eq(e.ranges[i],t))return!1;return!0}get main(){return this.ranges[this.mainIndex]}asSingle(){return this.ranges.length==1?this:new s([this.main],0)}addRange(e,t=!0){return s.create([e].concat(this.ranges),t?0:this.mainIndex+1)}replaceRange(e,t=this.mainIndex){let i=this.ranges.slice();return i[t]=e,s.create(i,this.mainIndex)}toJSON(){return{ranges:this.ranges.map(e=>e.toJSON()),main:this.mainIndex}}static fromJSON(e){if(!e||!Array.isArray(e.ranges)||typeof e.main!="number"||e.main>=e.ranges.length)throw new RangeError("Invalid JSON representation for EditorSelection");return new s(e.ranges.map(t=>cs.fromJSON(t)),e.main)}static single(e,t=e){return new s([s.range(e,t)],0)}static create(e,t=0){if(e.length==0)throw new RangeError("A selection needs at least one range");for(let i=0,n=0;n<e.length;n++){let r=e[n];if(r.empty?r.from<=i:r.from<i)return s.normalized(e.slice(),t);i=r.to}return new s(e,t)}static cursor(e,t=0,i,n){return cs.create(e,e,(t==0?0:t<0?8:16)|(i==null?7:Math.min(6,i)),n)}static range(e,t,i,n,r){let o=n==null?7:Math.min(6,n);return!r&&e!=t&&(r=t<e?1:-1),r&&(o|=r<0?8:16),t<e?cs.create(t,e,o|32,i):cs.create(e,t,o,i)}static undirectionalRange(e,t){return cs.create(e,t,64,void 0)}static normalized(e,t=0){let i=e[t];e.sort((n,r)=>n.from-r.from),t=e.indexOf(i);for(let n=1;n<e.length;n++){let r=e[n],o=e[n-1];if(r.empty?r.from<=o.to:r.from<o.to){let a=o.from,l=Math.max(r.to,o.to);n<=t&&t--,e.splice(--n,2,r.anchor>r.head?s.range(l,a):s.range(a,l))}}return new s(e,t)}};function gm(s,e){for(let t of s.ranges)if(t.to>e)throw new RangeError("Selection points outside of document")}var Vh=0,$=class s{constructor(e,t,i,n,r){this.combine=e,this.compareInput=t,this.compare=i,this.isStatic=n,this.id=Vh++,this.default=e([]),this.extensions=typeof r=="function"?r(this):r}get reader(){return this}static define(e={}){return new s(e.combine||(t=>t),e.compareInput||((t,i)=>t===i),e.compare||(e.combine?(t,i)=>t===i:Hh),!!e.static,e.enables)}of(e){return new lr([],this,0,e)}compute(e,t){if(this.isStatic)throw new Error("Can't compute a static facet");return new lr(e,this,1,t)}computeN(e,t){if(this.isStatic)throw new Error("Can't compute a static facet");return new lr(e,this,2,t)}from(e,t){return t||(t=i=>i),this.compute([e],i=>t(i.field(e)))}};function Hh(s,e){return s==e||s.length==e.length&&s.every((t,i)=>t===e[i])}var lr=class{constructor(e,t,i,n){this.dependencies=e,this.facet=t,this.type=i,this.value=n,this.id=Vh++}dynamicSlot(e){var t;let i=this.value,n=this.facet.compareInput,r=this.id,o=e[r]>>1,a=this.type==2,l=!1,c=!1,h=[];for(let u of this.dependencies)u=="doc"?l=!0:u=="selection"?c=!0:(((t=e[u.id])!==null&&t!==void 0?t:1)&1)==0&&h.push(e[u.id]);return{create(u){return u.values[o]=i(u),1},update(u,f){if(l&&f.docChanged||c&&(f.docChanged||f.selection)||Lh(u,h)){let d=i(u);if(a?!hm(d,u.values[o],n):!n(d,u.values[o]))return u.values[o]=d,1}return 0},reconfigure:(u,f)=>{let d,m=f.config.address[r];if(m!=null){let g=Da(f,m);if(this.dependencies.every(y=>y instanceof $?f.facet(y)===u.facet(y):y instanceof ot?f.field(y,!1)==u.field(y,!1):!0)||(a?hm(d=i(u),g,n):n(d=i(u),g)))return u.values[o]=g,0}else d=i(u);return u.values[o]=d,1}}}get extension(){return this}};function hm(s,e,t){if(s.length!=e.length)return!1;for(let i=0;i<s.length;i++)if(!t(s[i],e[i]))return!1;return!0}function Lh(s,e){let t=!1;for(let i of e)uo(s,i)&1&&(t=!0);return t}function b_(s,e,t){let i=t.map(l=>s[l.id]),n=t.map(l=>l.type),r=i.filter(l=>!(l&1)),o=s[e.id]>>1;function a(l){let c=[];for(let h=0;h<i.length;h++){let u=Da(l,i[h]);if(n[h]==2)for(let f of u)c.push(f);else c.push(u)}return e.combine(c)}return{create(l){for(let c of i)uo(l,c);return l.values[o]=a(l),1},update(l,c){if(!Lh(l,r))return 0;let h=a(l);return e.compare(h,l.values[o])?0:(l.values[o]=h,1)},reconfigure(l,c){let h=Lh(l,i),u=c.config.facets[e.id],f=c.facet(e);if(u&&!h&&Hh(t,u))return l.values[o]=f,0;let d=a(l);return e.compare(d,f)?(l.values[o]=f,0):(l.values[o]=d,1)}}}var Aa=$.define({static:!0}),ot=class s{constructor(e,t,i,n,r){this.id=e,this.createF=t,this.updateF=i,this.compareF=n,this.spec=r,this.provides=void 0}static define(e){let t=new s(Vh++,e.create,e.update,e.compare||((i,n)=>i===n),e);return e.provide&&(t.provides=e.provide(t)),t}create(e){let t=e.facet(Aa).find(i=>i.field==this);return(t?.create||this.createF)(e)}slot(e){let t=e[this.id]>>1;return{create:i=>(i.values[t]=this.create(i),1),update:(i,n)=>{let r=i.values[t],o=this.updateF(r,n);return this.compareF(r,o)?0:(i.values[t]=o,1)},reconfigure:(i,n)=>{let r=i.facet(Aa),o=n.facet(Aa),a;return(a=r.find(l=>l.field==this))&&a!=o.find(l=>l.field==this)?(i.values[t]=a.create(i),1):n.config.address[this.id]!=null?(i.values[t]=n.field(this),0):(i.values[t]=this.create(i),1)}}}init(e){return[this,Aa.of({field:this,create:e})]}get extension(){return this}},hs={lowest:4,low:3,default:2,high:1,highest:0};function ho(s){return e=>new ka(e,s)}var Dn={highest:ho(hs.highest),high:ho(hs.high),default:ho(hs.default),low:ho(hs.low),lowest:ho(hs.lowest)},ka=class{constructor(e,t){this.inner=e,this.prec=t}get extension(){return this}},La=class s{of(e){return new fo(this,e)}reconfigure(e){return s.reconfigure.of({compartment:this,extension:e})}get(e){return e.config.compartments.get(this)}},fo=class{constructor(e,t){this.compartment=e,this.inner=t}get extension(){return this}},Ia=class s{constructor(e,t,i,n,r,o){for(this.base=e,this.compartments=t,this.dynamicSlots=i,this.address=n,this.staticValues=r,this.facets=o,this.statusTemplate=[];this.statusTemplate.length<i.length;)this.statusTemplate.push(0)}staticFacet(e){let t=this.address[e.id];return t==null?e.default:this.staticValues[t>>1]}static resolve(e,t,i){let n=[],r=Object.create(null),o=new Map;for(let f of __(e,t,o))f instanceof ot?n.push(f):(r[f.facet.id]||(r[f.facet.id]=[])).push(f);let a=Object.create(null),l=[],c=[];for(let f of n)a[f.id]=c.length<<1,c.push(d=>f.slot(d));let h=i?.config.facets;for(let f in r){let d=r[f],m=d[0].facet,g=h&&h[f]||[];if(d.every(y=>y.type==0))if(a[m.id]=l.length<<1|1,Hh(g,d))l.push(i.facet(m));else{let y=m.combine(d.map(_=>_.value));l.push(i&&m.compare(y,i.facet(m))?i.facet(m):y)}else{for(let y of d)y.type==0?(a[y.id]=l.length<<1|1,l.push(y.value)):(a[y.id]=c.length<<1,c.push(_=>y.dynamicSlot(_)));a[m.id]=c.length<<1,c.push(y=>b_(y,m,d))}}let u=c.map(f=>f(a));return new s(e,o,u,a,l,r)}};function __(s,e,t){let i=[[],[],[],[],[]],n=new Map;function r(o,a){let l=n.get(o);if(l!=null){if(l<=a)return;let c=i[l].indexOf(o);c>-1&&i[l].splice(c,1),o instanceof fo&&t.delete(o.compartment)}if(n.set(o,a),Array.isArray(o))for(let c of o)r(c,a);else if(o instanceof fo){if(t.has(o.compartment))throw new RangeError("Duplicate use of compartment in extensions");let c=e.get(o.compartment)||o.inner;t.set(o.compartment,c),r(c,a)}else if(o instanceof ka)r(o.inner,o.prec);else if(o instanceof ot)i[a].push(o),o.provides&&r(o.provides,a);else if(o instanceof lr)i[a].push(o),o.facet.extensions&&r(o.facet.extensions,hs.default);else{let c=o.extension;if(!c)throw new Error(`Unrecognized extension value in extension set (${o}).`);if(c==o)throw new Error(`Unrecognized extension value in extension set (${o}). This sometimes happens because multiple instances of @codemirror/state are loaded, breaking instanceof checks.`);r(c,a)}}return r(s,hs.default),i.reduce((o,a)=>o.concat(a))}function uo(s,e){if(e&1)return 2;let t=e>>1,i=s.status[t];if(i==4)throw new Error("Cyclic dependency between fields and/or facets");if(i&2)return i;s.status[t]=4;let n=s.computeSlot(s,s.config.dynamicSlots[t]);return s.status[t]=2|n}function Da(s,e){return e&1?s.config.staticValues[e>>1]:s.values[e>>1]}var xm=$.define(),Ih=$.define({combine:s=>s.some(e=>e),static:!0}),vm=$.define({combine:s=>s.length?s[0]:void 0,static:!0}),ym=$.define(),bm=$.define(),_m=$.define(),Sm=$.define({combine:s=>s.length?s[0]:!1}),Di=class{constructor(e,t){this.type=e,this.value=t}static define(){return new Dh}},Dh=class{of(e){return new Di(this,e)}},Nh=class{constructor(e){this.map=e}of(e){return new de(this,e)}},de=class s{constructor(e,t){this.type=e,this.value=t}map(e){let t=this.type.map(this.value,e);return t===void 0?void 0:t==this.value?this:new s(this.type,t)}is(e){return this.type==e}static define(e={}){return new Nh(e.map||(t=>t))}static mapEffects(e,t){if(!e.length)return e;let i=[];for(let n of e){let r=n.map(t);r&&i.push(r)}return i}};de.reconfigure=de.define();de.appendConfig=de.define();var ut=class s{constructor(e,t,i,n,r,o){this.startState=e,this.changes=t,this.selection=i,this.effects=n,this.annotations=r,this.scrollIntoView=o,this._doc=null,this._state=null,i&&gm(i,t.newLength),r.some(a=>a.type==s.time)||(this.annotations=r.concat(s.time.of(Date.now())))}static create(e,t,i,n,r,o){return new s(e,t,i,n,r,o)}get newDoc(){return this._doc||(this._doc=this.changes.apply(this.startState.doc))}get newSelection(){return this.selection||this.startState.selection.map(this.changes)}get state(){return this._state||this.startState.applyTransaction(this),this._state}annotation(e){for(let t of this.annotations)if(t.type==e)return t.value}get docChanged(){return!this.changes.empty}get reconfigured(){return this.startState.config!=this.state.config}isUserEvent(e){let t=this.annotation(s.userEvent);return!!(t&&(t==e||t.length>e.length&&t.slice(0,e.length)==e&&t[e.length]=="."))}};ut.time=Di.define();ut.userEvent=Di.define();ut.addToHistory=Di.define();ut.remote=Di.define();function S_(s,e){let t=[];for(let i=0,n=0;;){let r,o;if(i<s.length&&(n==e.length||e[n]>=s[i]))r=s[i++],o=s[i++];else if(n<e.length)r=e[n++],o=e[n++];else return t;!t.length||t[t.length-1]<r?t.push(r,o):t[t.length-1]<o&&(t[t.length-1]=o)}}function wm(s,e,t){var i;let n,r,o;return t?(n=e.changes,r=Ut.empty(e.changes.length),o=s.changes.compose(e.changes)):(n=e.changes.map(s.changes),r=s.changes.mapDesc(e.changes,!0),o=s.changes.compose(n)),{changes:o,selection:e.selection?e.selection.map(r):(i=s.selection)===null||i===void 0?void 0:i.map(n),effects:de.mapEffects(s.effects,n).concat(de.mapEffects(e.effects,r)),annotations:s.annotations.length?s.annotations.concat(e.annotations):e.annotations,scrollIntoView:s.scrollIntoView||e.scrollIntoView}}function Oh(s,e,t){let i=e.selection,n=cr(e.annotations);return e.userEvent&&(n=n.concat(ut.userEvent.of(e.userEvent))),{changes:e.changes instanceof Ut?e.changes:Ut.of(e.changes||[],t,s.facet(vm)),selection:i&&(i instanceof I?i:I.single(i.anchor,i.head)),effects:cr(e.effects),annotations:n,scrollIntoView:!!e.scrollIntoView}}function Mm(s,e,t){let i=Oh(s,e.length?e[0]:{},s.doc.length);e.length&&e[0].filter===!1&&(t=!1);for(let r=1;r<e.length;r++){e[r].filter===!1&&(t=!1);let o=!!e[r].sequential;i=wm(i,Oh(s,e[r],o?i.changes.newLength:s.doc.length),o)}let n=ut.create(s,i.changes,i.selection,i.effects,i.annotations,i.scrollIntoView);return M_(t?w_(n):n)}function w_(s){let e=s.startState,t=!0;for(let n of e.facet(ym)){let r=n(s);if(r===!1){t=!1;break}Array.isArray(r)&&(t=t===!0?r:S_(t,r))}if(t!==!0){let n,r;if(t===!1)r=s.changes.invertedDesc,n=Ut.empty(e.doc.length);else{let o=s.changes.filter(t);n=o.changes,r=o.filtered.mapDesc(o.changes).invertedDesc}s=ut.create(e,n,s.selection&&s.selection.map(r),de.mapEffects(s.effects,r),s.annotations,s.scrollIntoView)}let i=e.facet(bm);for(let n=i.length-1;n>=0;n--){let r=i[n](s);r instanceof ut?s=r:Array.isArray(r)&&r.length==1&&r[0]instanceof ut?s=r[0]:s=Mm(e,cr(r),!1)}return s}function M_(s){let e=s.startState,t=e.facet(_m),i=s;for(let n=t.length-1;n>=0;n--){let r=t[n](s);r&&Object.keys(r).length&&(i=wm(i,Oh(e,r,s.changes.newLength),!0))}return i==s?s:ut.create(e,s.changes,s.selection,i.effects,i.annotations,i.scrollIntoView)}var A_=[];function cr(s){return s==null?A_:Array.isArray(s)?s:[s]}var Ye=(function(s){return s[s.Word=0]="Word",s[s.Space=1]="Space",s[s.Other=2]="Other",s})(Ye||(Ye={})),T_=/[\u00df\u0587\u0590-\u05f4\u0600-\u06ff\u3040-\u309f\u30a0-\u30ff\u3400-\u4db5\u4e00-\u9fcc\uac00-\ud7af]/,Fh;try{Fh=new RegExp("[\\p{Alphabetic}\\p{Number}_]","u")}catch{}function E_(s){if(Fh)return Fh.test(s);for(let e=0;e<s.length;e++){let t=s[e];if(/\w/.test(t)||t>""&&(t.toUpperCase()!=t.toLowerCase()||T_.test(t)))return!0}return!1}function C_(s){return e=>{if(!/\S/.test(e))return Ye.Space;if(E_(e))return Ye.Word;for(let t=0;t<s.length;t++)if(e.indexOf(s[t])>-1)return Ye.Word;return Ye.Other}}var Ue=class s{constructor(e,t,i,n,r,o){this.config=e,this.doc=t,this.selection=i,this.values=n,this.status=e.statusTemplate.slice(),this.computeSlot=r,o&&(o._state=this);for(let a=0;a<this.config.dynamicSlots.length;a++)uo(this,a<<1);this.computeSlot=null}field(e,t=!0){let i=this.config.address[e.id];if(i==null){if(t)throw new RangeError("Field is not present in this state");return}return uo(this,i),Da(this,i)}update(...e){return Mm(this,e,!0)}applyTransaction(e){let t=this.config,{base:i,compartments:n}=t;for(let a of e.effects)a.is(La.reconfigure)?(t&&(n=new Map,t.compartments.forEach((l,c)=>n.set(c,l)),t=null),n.set(a.value.compartment,a.value.extension)):a.is(de.reconfigure)?(t=null,i=a.value):a.is(de.appendConfig)&&(t=null,i=cr(i).concat(a.value));let r;t?r=e.startState.values.slice():(t=Ia.resolve(i,n,this),r=new s(t,this.doc,this.selection,t.dynamicSlots.map(()=>null),(l,c)=>c.reconfigure(l,this),null).values);let o=e.startState.facet(Ih)?e.newSelection:e.newSelection.asSingle();new s(t,e.newDoc,o,r,(a,l)=>l.update(a,e),e)}replaceSelection(e){return typeof e=="string"&&(e=this.toText(e)),this.changeByRange(t=>({changes:{from:t.from,to:t.to,insert:e},range:I.cursor(t.from+e.length,-1)}))}changeByRange(e){let t=this.selection,i=e(t.ranges[0]),n=this.changes(i.changes),r=[i.range],o=cr(i.effects);for(let a=1;a<t.ranges.length;a++){let l=e(t.ranges[a]),c=this.changes(l.changes),h=c.map(n);for(let f=0;f<a;f++)r[f]=r[f].map(h);let u=n.mapDesc(c,!0);r.push(l.range.map(u)),n=n.compose(h),o=de.mapEffects(o,h).concat(de.mapEffects(cr(l.effects),u))}return{changes:n,selection:I.create(r,t.mainIndex),effects:o}}changes(e=[]){return e instanceof Ut?e:Ut.of(e,this.doc.length,this.facet(s.lineSeparator))}toText(e){return be.of(e.split(this.facet(s.lineSeparator)||Rh))}sliceDoc(e=0,t=this.doc.length){return this.doc.sliceString(e,t,this.lineBreak)}facet(e){let t=this.config.address[e.id];return t==null?e.default:(uo(this,t),Da(this,t))}toJSON(e){let t={doc:this.sliceDoc(),selection:this.selection.toJSON()};if(e)for(let i in e){let n=e[i];n instanceof ot&&this.config.address[n.id]!=null&&(t[i]=n.spec.toJSON(this.field(e[i]),this))}return t}static fromJSON(e,t={},i){if(!e||typeof e.doc!="string")throw new RangeError("Invalid JSON representation for EditorState");let n=[];if(i){for(let r in i)if(Object.prototype.hasOwnProperty.call(e,r)){let o=i[r],a=e[r];n.push(o.init(l=>o.spec.fromJSON(a,l)))}}return s.create({doc:e.doc,selection:I.fromJSON(e.selection),extensions:t.extensions?n.concat([t.extensions]):n})}static create(e={}){let t=Ia.resolve(e.extensions||[],new Map),i=e.doc instanceof be?e.doc:be.of((e.doc||"").split(t.staticFacet(s.lineSeparator)||Rh)),n=e.selection?e.selection instanceof I?e.selection:I.single(e.selection.anchor,e.selection.head):I.single(0);return gm(n,i.length),t.staticFacet(Ih)||(n=n.asSingle()),new s(t,i,n,t.dynamicSlots.map(()=>null),(r,o)=>o.create(r),null)}get tabSize(){return this.facet(s.tabSize)}get lineBreak(){return this.facet(s.lineSeparator)||`
`}get readOnly(){return this.facet(Sm)}phrase(e,...t){for(let i of this.facet(s.phrases))if(Object.prototype.hasOwnProperty.call(i,e)){e=i[e];break}return t.length&&(e=e.replace(/\$(\$|\d*)/g,(i,n)=>{if(n=="$")return"$";let r=+(n||1);return!r||r>t.length?i:t[r-1]})),e}languageDataAt(e,t,i=-1){let n=[];for(let r of this.facet(xm))for(let o of r(this,t,i))Object.prototype.hasOwnProperty.call(o,e)&&n.push(o[e]);return n}charCategorizer(e){let t=this.languageDataAt("wordChars",e);return C_(t.length?t[0]:"")}wordAt(e){let{text:t,from:i,length:n}=this.doc.lineAt(e),r=this.charCategorizer(e),o=e-i,a=e-i;for(;o>0;){let l=nt(t,o,!1);if(r(t.slice(l,o))!=Ye.Word)break;o=l}for(;a<n;){let l=nt(t,a);if(r(t.slice(a,l))!=Ye.Word)break;a=l}return o==a?null:I.range(o+i,a+i)}};Ue.allowMultipleSelections=Ih;Ue.tabSize=$.define({combine:s=>s.length?s[0]:4});Ue.lineSeparator=vm;Ue.readOnly=Sm;Ue.phrases=$.define({compare(s,e){let t=Object.keys(s),i=Object.keys(e);return t.length==i.length&&t.every(n=>s[n]==e[n])}});Ue.languageData=xm;Ue.changeFilter=ym;Ue.transactionFilter=bm;Ue.transactionExtender=_m;La.reconfigure=de.define();function vi(s,e,t={}){let i={};for(let n of s)for(let r of Object.keys(n)){let o=n[r],a=i[r];if(a===void 0)i[r]=o;else if(!(a===o||o===void 0))if(Object.hasOwnProperty.call(t,r))i[r]=t[r](a,o);else throw new Error("Config merge conflict for field "+r)}for(let n in e)i[n]===void 0&&(i[n]=e[n]);return i}var nn=class{eq(e){return this==e}range(e,t=e){return po.create(e,t,this)}};nn.prototype.startSide=nn.prototype.endSide=0;nn.prototype.point=!1;nn.prototype.mapMode=Bt.TrackDel;function Gh(s,e){return s==e||s.constructor==e.constructor&&s.eq(e)}var po=class s{constructor(e,t,i){this.from=e,this.to=t,this.value=i}static create(e,t,i){return new s(e,t,i)}};function Bh(s,e){return s.from-e.from||s.value.startSide-e.value.startSide}var Uh=class s{constructor(e,t,i,n){this.from=e,this.to=t,this.value=i,this.maxPoint=n}get length(){return or(this.to)}findIndex(e,t,i,n=0){let r=i?this.to:this.from;for(let o=n,a=r.length;;){if(o==a)return o;let l=o+a>>1,c=r[l]-e||(i?this.value[l].endSide:this.value[l].startSide)-t;if(l==o)return c>=0?o:a;c>=0?a=l:o=l+1}}between(e,t,i,n){for(let r=this.findIndex(t,-1e9,!0),o=this.findIndex(i,1e9,!1,r);r<o;r++)if(n(this.from[r]+e,this.to[r]+e,this.value[r])===!1)return!1}map(e,t,i,n,r){let o=[],a=[],l=[],c=-1,h=-1;e:for(let u=0;u<this.value.length;u++){let f=this.value[u],d=this.from[u]+e,m=this.to[u]+e,g,y;if(d==m){let _=t.mapPos(d,f.startSide,f.mapMode);if(_==null||(g=y=_,f.startSide!=f.endSide&&(y=t.mapPos(d,f.endSide),y<g)))continue}else if(g=t.mapPos(d,f.startSide),y=t.mapPos(m,f.endSide),g>y||g==y&&f.startSide>0&&f.endSide<=0)continue;if(!((y-g||f.endSide-f.startSide)<0))if(c<0&&(c=g),f.point&&(h=Math.max(h,y-g)),(g-i||f.startSide-n)>=0)o.push(f),a.push(g-c),l.push(y-c),i=y,n=f.endSide;else{if(g==y)for(let _=o.length;_>0;_--){if((g-(l[_-1]+c)||f.startSide-o[_-1].endSide)>=0){o.splice(_,0,f),a.splice(_,0,g-c),l.splice(_,0,y-c);continue e}if((g-(a[_-1]+c)||f.endSide-o[_-1].startSide)>0)break}r(g,y,f)}}return{mapped:o.length?new s(a,l,o,h):null,pos:c}}},Me=class s{constructor(e,t,i,n){this.chunkPos=e,this.chunk=t,this.nextLayer=i,this.maxPoint=n}static create(e,t,i,n){return new s(e,t,i,n)}get length(){let e=this.chunk.length-1;return e<0?0:Math.max(this.chunkEnd(e),this.nextLayer.length)}get size(){if(this.isEmpty)return 0;let e=this.nextLayer.size;for(let t of this.chunk)e+=t.value.length;return e}chunkEnd(e){return this.chunkPos[e]+this.chunk[e].length}update(e){let{add:t=[],sort:i=!1,filterFrom:n=0,filterTo:r=this.length}=e,o=e.filter;if(t.length==0&&!o)return this;if(i&&(t=t.slice().sort(Bh)),this.isEmpty)return t.length?s.of(t):this;let a=new Na(this,null,-1).goto(0),l=0,c=[],h=new xi;for(;a.value||l<t.length;)if(l<t.length&&(a.from-t[l].from||a.startSide-t[l].value.startSide)>=0){let u=t[l++];h.addInner(u.from,u.to,u.value,!1)||c.push(u)}else a.rangeIndex==1&&a.chunkIndex<this.chunk.length&&(l==t.length||this.chunkEnd(a.chunkIndex)<t[l].from)&&(!o||n>this.chunkEnd(a.chunkIndex)||r<this.chunkPos[a.chunkIndex])&&h.addChunk(this.chunkPos[a.chunkIndex],this.chunk[a.chunkIndex])?a.nextChunk():((!o||n>a.to||r<a.from||o(a.from,a.to,a.value))&&(h.addInner(a.from,a.to,a.value,!1)||c.push(po.create(a.from,a.to,a.value))),a.next());return h.finishInner(this.nextLayer.isEmpty&&!c.length?s.empty:this.nextLayer.update({add:c,filter:o,filterFrom:n,filterTo:r}))}map(e){if(e.empty||this.isEmpty)return this;let t=[],i=[],n=-1,r,o=(l,c,h)=>{r||(r=new xi),r.addRange(l,c,h,!1)};for(let l=0;l<this.chunk.length;l++){let c=this.chunkPos[l],h=this.chunk[l],u=e.touchesRange(c,c+h.length);if(u===!1)n=Math.max(n,h.maxPoint),t.push(h),i.push(e.mapPos(c));else if(u===!0){let[f,d]=t.length?[or(i)+or(t).length,or(or(t).value).endSide]:[-1,-1],{mapped:m,pos:g}=h.map(c,e,f,d,o);m&&(n=Math.max(n,m.maxPoint),t.push(m),i.push(g))}}let a=this.nextLayer.map(e);return r&&(a=r.finishInner(a)),t.length==0?a:new s(i,t,a||s.empty,n)}between(e,t,i){if(!this.isEmpty){for(let n=0;n<this.chunk.length;n++){let r=this.chunkPos[n],o=this.chunk[n];if(t>=r&&e<=r+o.length&&o.between(r,e-r,t-r,i)===!1)return}this.nextLayer.between(e,t,i)}}iter(e=0){return mo.from([this]).goto(e)}get isEmpty(){return this.nextLayer==this}static iter(e,t=0){return mo.from(e).goto(t)}static compare(e,t,i,n,r=-1){let o=e.filter(u=>u.maxPoint>0||!u.isEmpty&&u.maxPoint>=r),a=t.filter(u=>u.maxPoint>0||!u.isEmpty&&u.maxPoint>=r),l=um(o,a,i),c=new us(o,l,r),h=new us(a,l,r);i.iterGaps((u,f,d)=>fm(c,u,h,f,d,n)),i.empty&&i.length==0&&fm(c,0,h,0,0,n)}static eq(e,t,i=0,n){n==null&&(n=999999999);let r=e.filter(h=>!h.isEmpty&&t.indexOf(h)<0),o=t.filter(h=>!h.isEmpty&&e.indexOf(h)<0);if(r.length!=o.length)return!1;if(!r.length)return!0;let a=um(r,o),l=new us(r,a,0).goto(i),c=new us(o,a,0).goto(i);for(;;){if(l.to!=c.to||!zh(l.active,c.active)||l.point&&(!c.point||!Gh(l.point,c.point)))return!1;if(l.to>n)return!0;l.next(),c.next()}}static spans(e,t,i,n,r=-1){let o=new us(e,null,r).goto(t),a=t,l=o.openStart;for(;;){let c=Math.min(o.to,i);if(o.point){let h=o.activeForPoint(o.to),u=o.pointFrom<t?h.length+1:o.point.startSide<0?h.length:Math.min(h.length,l);n.point(a,c,o.point,h,u,o.pointRank),l=Math.min(o.openEnd(c),h.length)}else c>a&&(n.span(a,c,o.active,l),l=o.openEnd(c));if(o.to>i)return l+(o.point&&o.to>i?1:0);a=o.to,o.next()}}static of(e,t=!1){let i=new xi;for(let n of e instanceof po?[e]:t?R_(e):e)i.add(n.from,n.to,n.value);return i.finish()}static join(e){if(!e.length)return s.empty;let t=or(e);for(let i=e.length-2;i>=0;i--)for(let n=e[i];n!=s.empty;n=n.nextLayer)t=new s(n.chunkPos,n.chunk,t,Math.max(n.maxPoint,t.maxPoint));return t}};Me.empty=new Me([],[],null,-1);function or(s){return s[s.length-1]}function R_(s){if(s.length>1)for(let e=s[0],t=1;t<s.length;t++){let i=s[t];if(Bh(e,i)>0)return s.slice().sort(Bh);e=i}return s}Me.empty.nextLayer=Me.empty;var xi=class s{finishChunk(e){this.chunks.push(new Uh(this.from,this.to,this.value,this.maxPoint)),this.chunkPos.push(this.chunkStart),this.chunkStart=-1,this.setMaxPoint=Math.max(this.setMaxPoint,this.maxPoint),this.maxPoint=-1,e&&(this.from=[],this.to=[],this.value=[])}constructor(){this.chunks=[],this.chunkPos=[],this.chunkStart=-1,this.last=null,this.lastFrom=-1e9,this.lastTo=-1e9,this.from=[],this.to=[],this.value=[],this.maxPoint=-1,this.setMaxPoint=-1,this.nextLayer=null}add(e,t,i){this.addRange(e,t,i,!0)}addRange(e,t,i,n){this.addInner(e,t,i,n)||(this.nextLayer||(this.nextLayer=new s)).addRange(e,t,i,n)}addInner(e,t,i,n){let r=e-this.lastTo||i.startSide-this.last.endSide;if(n&&r<=0&&(e-this.lastFrom||i.startSide-this.last.startSide)<0)throw new Error("Ranges must be added sorted by `from` position and `startSide`");return r<0?!1:(this.from.length==250&&this.finishChunk(!0),this.chunkStart<0&&(this.chunkStart=e),this.from.push(e-this.chunkStart),this.to.push(t-this.chunkStart),this.last=i,this.lastFrom=e,this.lastTo=t,this.value.push(i),i.point&&(this.maxPoint=Math.max(this.maxPoint,t-e)),!0)}addChunk(e,t){if((e-this.lastTo||t.value[0].startSide-this.last.endSide)<0)return!1;this.from.length&&this.finishChunk(!0),this.setMaxPoint=Math.max(this.setMaxPoint,t.maxPoint),this.chunks.push(t),this.chunkPos.push(e);let i=t.value.length-1;return this.last=t.value[i],this.lastFrom=t.from[i]+e,this.lastTo=t.to[i]+e,!0}finish(){return this.finishInner(Me.empty)}finishInner(e){if(this.from.length&&this.finishChunk(!1),this.chunks.length==0)return e;let t=Me.create(this.chunkPos,this.chunks,this.nextLayer?this.nextLayer.finishInner(e):e,this.setMaxPoint);return this.from=null,t}};function um(s,e,t){let i=new Map;for(let r of s)for(let o=0;o<r.chunk.length;o++)r.chunk[o].maxPoint<=0&&i.set(r.chunk[o],r.chunkPos[o]);let n=new Set;for(let r of e)for(let o=0;o<r.chunk.length;o++){let a=i.get(r.chunk[o]);a!=null&&(t?t.mapPos(a):a)==r.chunkPos[o]&&!t?.touchesRange(a,a+r.chunk[o].length)&&n.add(r.chunk[o])}return n}var Na=class{constructor(e,t,i,n=0){this.layer=e,this.skip=t,this.minPoint=i,this.rank=n}get startSide(){return this.value?this.value.startSide:0}get endSide(){return this.value?this.value.endSide:0}goto(e,t=-1e9){return this.chunkIndex=this.rangeIndex=0,this.gotoInner(e,t,!1),this}gotoInner(e,t,i){for(;this.chunkIndex<this.layer.chunk.length;){let n=this.layer.chunk[this.chunkIndex];if(!(this.skip&&this.skip.has(n)||this.layer.chunkEnd(this.chunkIndex)<e||n.maxPoint<this.minPoint))break;this.chunkIndex++,i=!1}if(this.chunkIndex<this.layer.chunk.length){let n=this.layer.chunk[this.chunkIndex].findIndex(e-this.layer.chunkPos[this.chunkIndex],t,!0);(!i||this.rangeIndex<n)&&this.setRangeIndex(n)}this.next()}forward(e,t){(this.to-e||this.endSide-t)<0&&this.gotoInner(e,t,!0)}next(){for(;;)if(this.chunkIndex==this.layer.chunk.length){this.from=this.to=1e9,this.value=null;break}else{let e=this.layer.chunkPos[this.chunkIndex],t=this.layer.chunk[this.chunkIndex],i=e+t.from[this.rangeIndex];if(this.from=i,this.to=e+t.to[this.rangeIndex],this.value=t.value[this.rangeIndex],this.setRangeIndex(this.rangeIndex+1),this.minPoint<0||this.value.point&&this.to-this.from>=this.minPoint)break}}setRangeIndex(e){if(e==this.layer.chunk[this.chunkIndex].value.length){if(this.chunkIndex++,this.skip)for(;this.chunkIndex<this.layer.chunk.length&&this.skip.has(this.layer.chunk[this.chunkIndex]);)this.chunkIndex++;this.rangeIndex=0}else this.rangeIndex=e}nextChunk(){this.chunkIndex++,this.rangeIndex=0,this.next()}compare(e){return this.from-e.from||this.startSide-e.startSide||this.rank-e.rank||this.to-e.to||this.endSide-e.endSide}},mo=class s{constructor(e){this.heap=e}static from(e,t=null,i=-1){let n=[];for(let r=0;r<e.length;r++)for(let o=e[r];!o.isEmpty;o=o.nextLayer)o.maxPoint>=i&&n.push(new Na(o,t,i,r));return n.length==1?n[0]:new s(n)}get startSide(){return this.value?this.value.startSide:0}goto(e,t=-1e9){for(let i of this.heap)i.goto(e,t);for(let i=this.heap.length>>1;i>=0;i--)Eh(this.heap,i);return this.next(),this}forward(e,t){for(let i of this.heap)i.forward(e,t);for(let i=this.heap.length>>1;i>=0;i--)Eh(this.heap,i);(this.to-e||this.value.endSide-t)<0&&this.next()}next(){if(this.heap.length==0)this.from=this.to=1e9,this.value=null,this.rank=-1;else{let e=this.heap[0];this.from=e.from,this.to=e.to,this.value=e.value,this.rank=e.rank,e.value&&e.next(),Eh(this.heap,0)}}};function Eh(s,e){for(let t=s[e];;){let i=(e<<1)+1;if(i>=s.length)break;let n=s[i];if(i+1<s.length&&n.compare(s[i+1])>=0&&(n=s[i+1],i++),t.compare(n)<0)break;s[i]=t,s[e]=n,e=i}}var us=class{constructor(e,t,i){this.minPoint=i,this.active=[],this.activeTo=[],this.activeRank=[],this.minActive=-1,this.point=null,this.pointFrom=0,this.pointRank=0,this.to=-1e9,this.endSide=0,this.openStart=-1,this.cursor=mo.from(e,t,i)}goto(e,t=-1e9){return this.cursor.goto(e,t),this.active.length=this.activeTo.length=this.activeRank.length=0,this.minActive=-1,this.to=e,this.endSide=t,this.openStart=-1,this.next(),this}forward(e,t){for(;this.minActive>-1&&(this.activeTo[this.minActive]-e||this.active[this.minActive].endSide-t)<0;)this.removeActive(this.minActive);this.cursor.forward(e,t)}removeActive(e){Ta(this.active,e),Ta(this.activeTo,e),Ta(this.activeRank,e),this.minActive=dm(this.active,this.activeTo)}addActive(e){let t=0,{value:i,to:n,rank:r}=this.cursor;for(;t<this.activeRank.length&&(r-this.activeRank[t]||n-this.activeTo[t])>0;)t++;Ea(this.active,t,i),Ea(this.activeTo,t,n),Ea(this.activeRank,t,r),e&&Ea(e,t,this.cursor.from),this.minActive=dm(this.active,this.activeTo)}next(){let e=this.to,t=this.point;this.point=null;let i=this.openStart<0?[]:null;for(;;){let n=this.minActive;if(n>-1&&(this.activeTo[n]-this.cursor.from||this.active[n].endSide-this.cursor.startSide)<0){if(this.activeTo[n]>e){this.to=this.activeTo[n],this.endSide=this.active[n].endSide;break}this.removeActive(n),i&&Ta(i,n)}else if(this.cursor.value)if(this.cursor.from>e){this.to=this.cursor.from,this.endSide=this.cursor.startSide;break}else{let r=this.cursor.value;if(!r.point)this.addActive(i),this.cursor.next();else if(t&&this.cursor.to==this.to&&this.cursor.from<this.cursor.to)this.cursor.next();else{this.point=r,this.pointFrom=this.cursor.from,this.pointRank=this.cursor.rank,this.to=this.cursor.to,this.endSide=r.endSide,this.cursor.next(),this.forward(this.to,this.endSide);break}}else{this.to=this.endSide=1e9;break}}if(i){this.openStart=0;for(let n=i.length-1;n>=0&&i[n]<e;n--)this.openStart++}}activeForPoint(e){if(!this.active.length)return this.active;let t=[];for(let i=this.active.length-1;i>=0&&!(this.activeRank[i]<this.pointRank);i--)(this.activeTo[i]>e||this.activeTo[i]==e&&this.active[i].endSide>=this.point.endSide)&&t.push(this.active[i]);return t.reverse()}openEnd(e){let t=0;for(let i=this.activeTo.length-1;i>=0&&this.activeTo[i]>e;i--)t++;return t}};function fm(s,e,t,i,n,r){s.goto(e),t.goto(i);let o=i+n,a=i,l=i-e,c=!!r.boundChange;for(let h=!1;;){let u=s.to+l-t.to,f=u||s.endSide-t.endSide,d=f<0?s.to+l:t.to,m=Math.min(d,o);if(s.point||t.point?(s.point&&t.point&&Gh(s.point,t.point)&&zh(s.activeForPoint(s.to),t.activeForPoint(t.to))||r.comparePoint(a,m,s.point,t.point),h=!1):(h&&(r.boundChange(a),h=!1),m>a&&!zh(s.active,t.active)&&r.compareRange(a,m,s.active,t.active),c&&m<o&&(u||s.openEnd(d)!=t.openEnd(d))&&(h=!0)),d>o)break;a=d,f<=0&&s.next(),f>=0&&t.next()}}function zh(s,e){if(s.length!=e.length)return!1;for(let t=0;t<s.length;t++)if(s[t]!=e[t]&&!Gh(s[t],e[t]))return!1;return!0}function Ta(s,e){for(let t=e,i=s.length-1;t<i;t++)s[t]=s[t+1];s.pop()}function Ea(s,e,t){for(let i=s.length-1;i>=e;i--)s[i+1]=s[i];s[e]=t}function dm(s,e){let t=-1,i=1e9;for(let n=0;n<e.length;n++)(e[n]-i||s[n].endSide-s[t].endSide)<0&&(t=n,i=e[n]);return t}function ps(s,e,t=s.length){let i=0;for(let n=0;n<t&&n<s.length;)s.charCodeAt(n)==9?(i+=e-i%e,n++):(i++,n=nt(s,n));return i}function Am(s,e,t,i){for(let n=0,r=0;;){if(r>=e)return n;if(n==s.length)break;r+=s.charCodeAt(n)==9?t-r%t:1,n=nt(s,n)}return i===!0?-1:s.length}var Tm=typeof Symbol>"u"?"__ͼ":Symbol.for("ͼ"),Wh=typeof Symbol>"u"?"__styleSet"+Math.floor(Math.random()*1e8):Symbol("styleSet"),Em=typeof globalThis<"u"?globalThis:typeof window<"u"?window:{},yi=class{constructor(e,t){this.rules=[];let{finish:i}=t||{};function n(o){return/^@/.test(o)?[o]:o.split(/,\s*/)}function r(o,a,l,c){let h=[],u=/^@(\w+)\b/.exec(o[0]),f=u&&u[1]=="keyframes";if(u&&a==null)return l.push(o[0]+";");for(let d in a){let m=a[d];if(/&/.test(d))r(d.split(/,\s*/).map(g=>o.map(y=>g.replace(/&/,y))).reduce((g,y)=>g.concat(y)),m,l);else if(m&&typeof m=="object"){if(!u)throw new RangeError("The value of a property ("+d+") should be a primitive value.");r(n(d),m,h,f)}else m!=null&&h.push(d.replace(/_.*/,"").replace(/[A-Z]/g,g=>"-"+g.toLowerCase())+": "+m+";")}(h.length||f)&&l.push((i&&!u&&!c?o.map(i):o).join(", ")+" {"+h.join(" ")+"}")}for(let o in e)r(n(o),e[o],this.rules)}getRules(){return this.rules.join(`
`)}static newName(){let e=Em[Tm]||1;return Em[Tm]=e+1,"ͼ"+e.toString(36)}static mount(e,t,i){let n=e[Wh],r=i&&i.nonce;n?r&&n.setNonce(r):n=new qh(e,r),n.mount(Array.isArray(t)?t:[t],e)}},Cm=new Map,qh=class{constructor(e,t){let i=e.ownerDocument||e,n=i.defaultView;if(!e.head&&e.adoptedStyleSheets&&n.CSSStyleSheet){let r=Cm.get(i);if(r)return e[Wh]=r;this.sheet=new n.CSSStyleSheet,Cm.set(i,this)}else this.styleTag=i.createElement("style"),t&&this.styleTag.setAttribute("nonce",t);this.modules=[],e[Wh]=this}mount(e,t){let i=this.sheet,n=0,r=0,o=!1;for(let a=0;a<e.length;a++){let l=e[a],c=this.modules.indexOf(l);if(c<r&&c>-1&&(this.modules.splice(c,1),o=!0,r--,c=-1),c==-1){if(this.modules.splice(r++,0,l),o=!0,i)for(let h=0;h<l.rules.length;h++)i.insertRule(l.rules[h],n++)}else{for(;r<c;)n+=this.modules[r++].rules.length;n+=l.rules.length,r++}}if(i)t.adoptedStyleSheets.indexOf(this.sheet)<0&&(t.adoptedStyleSheets=[this.sheet,...t.adoptedStyleSheets]);else{if(o){let l="";for(let c=0;c<this.modules.length;c++)l+=this.modules[c].getRules()+`
`;this.styleTag.textContent=l}let a=t.head||t;this.styleTag.parentNode!=a&&a.insertBefore(this.styleTag,a.firstChild)}}setNonce(e){this.styleTag&&this.styleTag.getAttribute("nonce")!=e&&this.styleTag.setAttribute("nonce",e)}};var gn={8:"Backspace",9:"Tab",10:"Enter",12:"NumLock",13:"Enter",16:"Shift",17:"Control",18:"Alt",20:"CapsLock",27:"Escape",32:" ",33:"PageUp",34:"PageDown",35:"End",36:"Home",37:"ArrowLeft",38:"ArrowUp",39:"ArrowRight",40:"ArrowDown",44:"PrintScreen",45:"Insert",46:"Delete",59:";",61:"=",91:"Meta",92:"Meta",106:"*",107:"+",108:",",109:"-",110:".",111:"/",144:"NumLock",145:"ScrollLock",160:"Shift",161:"Shift",162:"Control",163:"Control",164:"Alt",165:"Alt",173:"-",186:";",187:"=",188:",",189:"-",190:".",191:"/",192:"`",219:"[",220:"\\",221:"]",222:"'"},ur={48:")",49:"!",50:"@",51:"#",52:"$",53:"%",54:"^",55:"&",56:"*",57:"(",59:":",61:"+",173:"_",186:":",187:"+",188:"<",189:"_",190:">",191:"?",192:"~",219:"{",220:"|",221:"}",222:'"'},P_=typeof navigator<"u"&&/Mac/.test(navigator.platform),k_=typeof navigator<"u"&&/MSIE \d|Trident\/(?:[7-9]|\d{2,})\..*rv:(\d+)/.exec(navigator.userAgent);for(at=0;at<10;at++)gn[48+at]=gn[96+at]=String(at);var at;for(at=1;at<=24;at++)gn[at+111]="F"+at;var at;for(at=65;at<=90;at++)gn[at]=String.fromCharCode(at+32),ur[at]=String.fromCharCode(at);var at;for(Ba in gn)ur.hasOwnProperty(Ba)||(ur[Ba]=gn[Ba]);var Ba;function Rm(s){var e=P_&&s.metaKey&&s.shiftKey&&!s.ctrlKey&&!s.altKey||k_&&s.shiftKey&&s.key&&s.key.length==1||s.key=="Unidentified",t=!e&&s.key||(s.shiftKey?ur:gn)[s.keyCode]||s.key||"Unidentified";return t=="Esc"&&(t="Escape"),t=="Del"&&(t="Delete"),t=="Left"&&(t="ArrowLeft"),t=="Up"&&(t="ArrowUp"),t=="Right"&&(t="ArrowRight"),t=="Down"&&(t="ArrowDown"),t}function Ae(){var s=arguments[0];typeof s=="string"&&(s=document.createElement(s));var e=1,t=arguments[1];if(t&&typeof t=="object"&&t.nodeType==null&&!Array.isArray(t)){for(var i in t)if(Object.prototype.hasOwnProperty.call(t,i)){var n=t[i];typeof n=="string"?s.setAttribute(i,n):n!=null&&(s[i]=n)}e++}for(;e<arguments.length;e++)Pm(s,arguments[e]);return s}function Pm(s,e){if(typeof e=="string")s.appendChild(document.createTextNode(e));else if(e!=null)if(e.nodeType!=null)s.appendChild(e);else if(Array.isArray(e))for(var t=0;t<e.length;t++)Pm(s,e[t]);else throw new RangeError("Unsupported child node: "+e)}var zt=typeof navigator<"u"?navigator:{userAgent:"",vendor:"",platform:""},eu=typeof document<"u"?document:{documentElement:{style:{}}},tu=/Edge\/(\d+)/.exec(zt.userAgent),ug=/MSIE \d/.test(zt.userAgent),iu=/Trident\/(?:[7-9]|\d{2,})\..*rv:(\d+)/.exec(zt.userAgent),ml=!!(ug||iu||tu),km=!ml&&/gecko\/(\d+)/i.test(zt.userAgent),Xh=!ml&&/Chrome\/(\d+)/.exec(zt.userAgent),Lm="webkitFontSmoothing"in eu.documentElement.style,nu=!ml&&/Apple Computer/.test(zt.vendor),Im=nu&&(/Mobile\/\w+/.test(zt.userAgent)||zt.maxTouchPoints>2),q={mac:Im||/Mac/.test(zt.platform),windows:/Win/.test(zt.platform),linux:/Linux|X11/.test(zt.platform),ie:ml,ie_version:ug?eu.documentMode||6:iu?+iu[1]:tu?+tu[1]:0,gecko:km,gecko_version:km?+(/Firefox\/(\d+)/.exec(zt.userAgent)||[0,0])[1]:0,chrome:!!Xh,chrome_version:Xh?+Xh[1]:0,ios:Im,android:/Android\b/.test(zt.userAgent),webkit:Lm,webkit_version:Lm?+(/\bAppleWebKit\/(\d+)/.exec(zt.userAgent)||[0,0])[1]:0,safari:nu,safari_version:nu?+(/\bVersion\/(\d+(\.\d+)?)/.exec(zt.userAgent)||[0,0])[1]:0,tabSize:eu.documentElement.style.tabSize!=null?"tab-size":"-moz-tab-size"};function $u(s,e){for(let t in s)t=="class"&&e.class?e.class+=" "+s.class:t=="style"&&e.style?e.style+=";"+s.style:e[t]=s[t];return e}var ja=Object.create(null);function Yu(s,e,t){if(s==e)return!0;s||(s=ja),e||(e=ja);let i=Object.keys(s),n=Object.keys(e);if(i.length-0!=n.length-0)return!1;for(let r of i)if(r!=t&&(n.indexOf(r)==-1||s[r]!==e[r]))return!1;return!0}function L_(s,e){for(let t=s.attributes.length-1;t>=0;t--){let i=s.attributes[t].name;e[i]==null&&s.removeAttribute(i)}for(let t in e){let i=e[t];t=="style"?s.style.cssText=i:s.getAttribute(t)!=i&&s.setAttribute(t,i)}}function Dm(s,e,t){let i=!1;if(e)for(let n in e)t&&n in t||(i=!0,n=="style"?s.style.cssText="":s.removeAttribute(n));if(t)for(let n in t)e&&e[n]==t[n]||(i=!0,n=="style"?s.style.cssText=t[n]:s.setAttribute(n,t[n]));return i}function I_(s){let e=Object.create(null);for(let t=0;t<s.attributes.length;t++){let i=s.attributes[t];e[i.name]=i.value}return e}var yn=class{eq(e){return!1}updateDOM(e,t,i){return!1}compare(e){return this==e||this.constructor==e.constructor&&this.eq(e)}get estimatedHeight(){return-1}get lineBreaks(){return 0}ignoreEvent(e){return!0}coordsAt(e,t,i){return null}get isHidden(){return!1}get editable(){return!1}destroy(e){}},Tt=(function(s){return s[s.Text=0]="Text",s[s.WidgetBefore=1]="WidgetBefore",s[s.WidgetAfter=2]="WidgetAfter",s[s.WidgetRange=3]="WidgetRange",s})(Tt||(Tt={})),oe=class extends nn{constructor(e,t,i,n){super(),this.startSide=e,this.endSide=t,this.widget=i,this.spec=n}get heightRelevant(){return!1}static mark(e){return new Eo(e)}static widget(e){let t=Math.max(-1e4,Math.min(1e4,e.side||0)),i=!!e.block;return t+=i&&!e.inlineOrder?t>0?3e8:-4e8:t>0?1e8:-1e8,new vs(e,t,t,i,e.widget||null,!1)}static replace(e){let t=!!e.block,i,n;if(e.isBlockGap)i=-5e8,n=4e8;else{let{start:r,end:o}=fg(e,t);i=(r?t?-3e8:-1:5e8)-1,n=(o?t?2e8:1:-6e8)+1}return new vs(e,i,n,t,e.widget||null,!0)}static line(e){return new Co(e)}static set(e,t=!1){return Me.of(e,t)}hasHeight(){return this.widget?this.widget.estimatedHeight>-1:!1}};oe.none=Me.empty;var Eo=class s extends oe{constructor(e){let{start:t,end:i}=fg(e);super(t?-1:5e8,i?1:-6e8,null,e),this.tagName=e.tagName||"span",this.attrs=e.class&&e.attributes?$u(e.attributes,{class:e.class}):e.class?{class:e.class}:e.attributes||ja}eq(e){return this==e||e instanceof s&&this.tagName==e.tagName&&Yu(this.attrs,e.attrs)}range(e,t=e){if(e>=t)throw new RangeError("Mark decorations may not be empty");return super.range(e,t)}};Eo.prototype.point=!1;var Co=class s extends oe{constructor(e){super(-2e8,-2e8,null,e)}eq(e){return e instanceof s&&this.spec.class==e.spec.class&&Yu(this.spec.attributes,e.spec.attributes)}range(e,t=e){if(t!=e)throw new RangeError("Line decoration ranges must be zero-length");return super.range(e,t)}};Co.prototype.mapMode=Bt.TrackBefore;Co.prototype.point=!0;var vs=class s extends oe{constructor(e,t,i,n,r,o){super(t,i,r,e),this.block=n,this.isReplace=o,this.mapMode=n?t<=0?Bt.TrackBefore:Bt.TrackAfter:Bt.TrackDel}get type(){return this.startSide!=this.endSide?Tt.WidgetRange:this.startSide<=0?Tt.WidgetBefore:Tt.WidgetAfter}get heightRelevant(){return this.block||!!this.widget&&(this.widget.estimatedHeight>=5||this.widget.lineBreaks>0)}eq(e){return e instanceof s&&D_(this.widget,e.widget)&&this.block==e.block&&this.startSide==e.startSide&&this.endSide==e.endSide}range(e,t=e){if(this.isReplace&&(e>t||e==t&&this.startSide>0&&this.endSide<=0))throw new RangeError("Invalid range for replacement decoration");if(!this.isReplace&&t!=e)throw new RangeError("Widget decorations can only have zero-length ranges");return super.range(e,t)}};vs.prototype.point=!0;function fg(s,e=!1){let{inclusiveStart:t,inclusiveEnd:i}=s;return t==null&&(t=s.inclusive),i==null&&(i=s.inclusive),{start:t??e,end:i??e}}function D_(s,e){return s==e||!!(s&&e&&s.compare(e))}function xr(s,e,t,i=0){let n=t.length-1;n>=0&&t[n]+i>=s?t[n]=Math.max(t[n],e):t.push(s,e)}var Qa=class s extends nn{constructor(e,t,i){super(),this.tagName=e,this.attributes=t,this.rank=i}eq(e){return e==this||e instanceof s&&this.tagName==e.tagName&&Yu(this.attributes,e.attributes)}static create(e){return new s(e.tagName,e.attributes||ja,e.rank==null?50:Math.max(0,Math.min(e.rank,100)))}static set(e,t=!1){return Me.of(e,t)}};Qa.prototype.startSide=Qa.prototype.endSide=-1;var bt=s=>s.nodeType==1,yr=s=>s.nodeType==3;function Ro(s){let e;return s.nodeType==11?e=s.getSelection?s:s.ownerDocument:e=s,e.getSelection()}function su(s,e){return e?s==e||s.contains(e.nodeType!=1?e.parentNode:e):!1}function vo(s,e){if(!e.anchorNode)return!1;try{return su(s,e.anchorNode)}catch{return!1}}function Ya(s){return yr(s)?Po(s,0,s.nodeValue.length).getClientRects():bt(s)?s.getClientRects():[]}function yo(s,e,t,i){return t?Nm(s,e,t,i,-1)||Nm(s,e,t,i,1):!1}function Fn(s){for(var e=0;;e++)if(s=s.previousSibling,!s)return e}function el(s){return bt(s)&&/^(DIV|P|LI|UL|OL|BLOCKQUOTE|DD|DT|H\d|SECTION|PRE)$/.test(s.nodeName)}function Nm(s,e,t,i,n){for(;;){if(s==t&&e==i)return!0;if(e==(n<0?0:bn(s))){if(s.nodeName=="DIV")return!1;let r=s.parentNode;if(!r||!bt(r))return!1;e=Fn(s)+(n<0?0:1),s=r}else if(bt(s)){if(s=s.childNodes[e+(n<0?-1:0)],bt(s)&&(s.nodeName=="IMG"||s.nodeName=="BR"||s.contentEditable=="false"))return!1;e=n<0?bn(s):0}else return!1}}function bn(s){return yr(s)?s.nodeValue.length:s.childNodes.length}function tl(s,e){let{left:t,right:i}=s;if(t==i)return s;let n=e?t:i;return{left:n,right:n,top:s.top,bottom:s.bottom}}function N_(s){let e=s.visualViewport;return e?{left:0,right:e.width,top:0,bottom:e.height}:{left:0,right:s.innerWidth,top:0,bottom:s.innerHeight}}function dg(s,e){let t=e.width/s.offsetWidth,i=e.height/s.offsetHeight;return(t>.995&&t<1.005||!isFinite(t)||Math.abs(e.width-s.offsetWidth)<1)&&(t=1),(i>.995&&i<1.005||!isFinite(i)||Math.abs(e.height-s.offsetHeight)<1)&&(i=1),{scaleX:t,scaleY:i}}function O_(s,e,t,i,n,r,o,a){let l=s.ownerDocument,c=l.defaultView||window;for(let h=s,u=!1;h&&!u;)if(bt(h)){let f,d=h==l.body,m=1,g=1,y=!0,_=!0;if(d)f=N_(c);else{let T=getComputedStyle(h);if(/^(fixed|sticky)$/.test(T.position)&&(u=!0),(h.scrollHeight<=h.clientHeight||!/auto|scroll/.test(T.overflowY))&&(_=!1),(h.scrollWidth<=h.clientWidth||!/auto|scroll/.test(T.overflowX))&&(y=!1),!y&&!_){h=h.assignedSlot||h.parentNode;continue}let C=h.getBoundingClientRect();({scaleX:m,scaleY:g}=dg(h,C)),f={left:C.left,right:C.left+h.clientWidth*m,top:C.top,bottom:C.top+h.clientHeight*g}}let w=0,A=0;if(_)if(n=="nearest")e.top<f.top+o?(A=e.top-(f.top+o),t>0&&e.bottom>f.bottom+A&&(A=e.bottom-f.bottom+o)):e.bottom>f.bottom-o&&(A=e.bottom-f.bottom+o,t<0&&e.top-A<f.top&&(A=e.top-(f.top+o)));else{let T=e.bottom-e.top,C=f.bottom-f.top;A=(n=="center"&&T<=C?e.top+T/2-C/2:n=="start"||n=="center"&&t<0?e.top-o:e.bottom-C+o)-f.top}if(y&&(i=="nearest"?e.left<f.left+r?(w=e.left-(f.left+r),t>0&&e.right>f.right+w&&(w=e.right-f.right+r)):e.right>f.right-r&&(w=e.right-f.right+r,t<0&&e.left<f.left+w&&(w=e.left-(f.left+r))):w=(i=="center"?e.left+(e.right-e.left)/2-(f.right-f.left)/2:i=="start"==a?e.left-r:e.right-(f.right-f.left)+r)-f.left),w||A)if(d)c.scrollBy(w,A);else{let T=0,C=0;if(A){let E=h.scrollTop;h.scrollTop+=A/g,C=(h.scrollTop-E)*g}if(w){let E=h.scrollLeft;h.scrollLeft+=w/m,T=(h.scrollLeft-E)*m}e={left:e.left-T,top:e.top-C,right:e.right-T,bottom:e.bottom-C},T&&Math.abs(T-w)<1&&(i="nearest"),C&&Math.abs(C-A)<1&&(n="nearest")}if(d)break;(e.top<f.top||e.bottom>f.bottom||e.left<f.left||e.right>f.right)&&(e={left:Math.max(e.left,f.left),right:Math.min(e.right,f.right),top:Math.max(e.top,f.top),bottom:Math.min(e.bottom,f.bottom)}),h=h.assignedSlot||h.parentNode}else if(h.nodeType==11)h=h.host;else break}function pg(s,e=!0){let t=s.ownerDocument,i=null,n=null;for(let r=s.parentNode;r&&!(r==t.body||(!e||i)&&n);)if(bt(r))!n&&r.scrollHeight>r.clientHeight&&/scroll|auto/.test(getComputedStyle(r).overflowY)&&(n=r),e&&!i&&r.scrollWidth>r.clientWidth&&/scroll|auto/.test(getComputedStyle(r).overflowX)&&(i=r),r=r.assignedSlot||r.parentNode;else if(r.nodeType==11)r=r.host;else break;return{x:i,y:n}}var ru=class{constructor(){this.anchorNode=null,this.anchorOffset=0,this.focusNode=null,this.focusOffset=0}eq(e){return this.anchorNode==e.anchorNode&&this.anchorOffset==e.anchorOffset&&this.focusNode==e.focusNode&&this.focusOffset==e.focusOffset}setRange(e){let{anchorNode:t,focusNode:i}=e;this.set(t,Math.min(e.anchorOffset,t?bn(t):0),i,Math.min(e.focusOffset,i?bn(i):0))}set(e,t,i,n){this.anchorNode=e,this.anchorOffset=t,this.focusNode=i,this.focusOffset=n}};function mg(s){let e=[];for(let t=s;t;t=t.nodeType==11?t.host:t.parentNode)bt(t)&&e.push({node:t,left:t.scrollLeft,top:t.scrollTop});return e}function gg(s,e=!0){for(let{node:t,left:i,top:n}of s)e&&t.scrollTop!=n&&(t.scrollTop=n),t.scrollLeft!=i&&(t.scrollLeft=i)}var ms=null;q.safari&&q.safari_version>=26&&(ms=!1);function xg(s){if(s.setActive)return s.setActive();if(ms)return s.focus(ms);let e=mg(s);s.focus(ms==null?{get preventScroll(){return ms={preventScroll:!0},!0}}:void 0),ms||(ms=!1,gg(e))}var Om;function Po(s,e,t=e){let i=Om||(Om=document.createRange());return i.setEnd(s,t),i.setStart(s,e),i}function vr(s,e,t,i){let n={key:e,code:e,keyCode:t,which:t,cancelable:!0};i&&({altKey:n.altKey,ctrlKey:n.ctrlKey,shiftKey:n.shiftKey,metaKey:n.metaKey}=i);let r=new KeyboardEvent("keydown",n);r.synthetic=!0,s.dispatchEvent(r);let o=new KeyboardEvent("keyup",n);return o.synthetic=!0,s.dispatchEvent(o),r.defaultPrevented||o.defaultPrevented}function F_(s){for(;s;){if(s&&(s.nodeType==9||s.nodeType==11&&s.host))return s;s=s.assignedSlot||s.parentNode}return null}function B_(s,e){let t=e.focusNode,i=e.focusOffset;if(!t||e.anchorNode!=t||e.anchorOffset!=i)return!1;for(i=Math.min(i,bn(t));;)if(i){if(!bt(t))return!1;let n=t.childNodes[i-1];n.contentEditable=="false"?i--:(t=n,i=bn(t))}else{if(t==s)return!0;i=Fn(t),t=t.parentNode}}function vg(s){return s instanceof Window?s.pageYOffset>Math.max(0,s.document.documentElement.scrollHeight-s.innerHeight-4):s.scrollTop>Math.max(1,s.scrollHeight-s.clientHeight-4)}function yg(s,e){for(let t=s,i=e;;){if(yr(t)&&i>0)return{node:t,offset:i};if(bt(t)&&i>0){if(t.contentEditable=="false")return null;t=t.childNodes[i-1],i=bn(t)}else if(t.parentNode&&!el(t))i=Fn(t),t=t.parentNode;else return null}}function bg(s,e){for(let t=s,i=e;;){if(yr(t)&&i<t.nodeValue.length)return{node:t,offset:i};if(bt(t)&&i<t.childNodes.length){if(t.contentEditable=="false")return null;t=t.childNodes[i],i=0}else if(t.parentNode&&!el(t))i=Fn(t)+1,t=t.parentNode;else return null}}var rn=class s{constructor(e,t,i=!0){this.node=e,this.offset=t,this.precise=i}static before(e,t){return new s(e.parentNode,Fn(e),t)}static after(e,t){return new s(e.parentNode,Fn(e)+1,t)}},Ie=(function(s){return s[s.LTR=0]="LTR",s[s.RTL=1]="RTL",s})(Ie||(Ie={})),br=Ie.LTR,Ku=Ie.RTL;function _g(s){let e=[];for(let t=0;t<s.length;t++)e.push(1<<+s[t]);return e}var U_=_g("88888888888888888888888888888888888666888888787833333333337888888000000000000000000000000008888880000000000000000000000000088888888888888888888888888888888888887866668888088888663380888308888800000000000000000000000800000000000000000000000000000008"),z_=_g("4444448826627288999999999992222222222222222222222222222222222222222222222229999999999999999999994444444444644222822222222222222222222222222222222222222222222222222222222222222222222222222222222222222222222222222222999999949999999229989999223333333333"),ou=Object.create(null),sn=[];for(let s of["()","[]","{}"]){let e=s.charCodeAt(0),t=s.charCodeAt(1);ou[e]=t,ou[t]=-e}function Sg(s){return s<=247?U_[s]:1424<=s&&s<=1524?2:1536<=s&&s<=1785?z_[s-1536]:1774<=s&&s<=2220?4:8192<=s&&s<=8204?256:64336<=s&&s<=65023?4:1}var V_=/[\u0590-\u05f4\u0600-\u06ff\u0700-\u08ac\ufb50-\ufdff]/,Si=class{get dir(){return this.level%2?Ku:br}constructor(e,t,i){this.from=e,this.to=t,this.level=i}side(e,t){return this.dir==t==e?this.to:this.from}forward(e,t){return e==(this.dir==t)}static find(e,t,i,n){let r=-1;for(let o=0;o<e.length;o++){let a=e[o];if(a.from<=t&&a.to>=t){if(a.level==i)return o;(r<0||(n!=0?n<0?a.from<t:a.to>t:e[r].level>a.level))&&(r=o)}}if(r<0)throw new RangeError("Index out of range");return r}};function wg(s,e){if(s.length!=e.length)return!1;for(let t=0;t<s.length;t++){let i=s[t],n=e[t];if(i.from!=n.from||i.to!=n.to||i.direction!=n.direction||!wg(i.inner,n.inner))return!1}return!0}var Ne=[];function H_(s,e,t,i,n){for(let r=0;r<=i.length;r++){let o=r?i[r-1].to:e,a=r<i.length?i[r].from:t,l=r?256:n;for(let c=o,h=l,u=l;c<a;c++){let f=Sg(s.charCodeAt(c));f==512?f=h:f==8&&u==4&&(f=16),Ne[c]=f==4?2:f,f&7&&(u=f),h=f}for(let c=o,h=l,u=l;c<a;c++){let f=Ne[c];if(f==128)c<a-1&&h==Ne[c+1]&&h&24?f=Ne[c]=h:Ne[c]=256;else if(f==64){let d=c+1;for(;d<a&&Ne[d]==64;)d++;let m=c&&h==8||d<t&&Ne[d]==8?u==1?1:8:256;for(let g=c;g<d;g++)Ne[g]=m;c=d-1}else f==8&&u==1&&(Ne[c]=1);h=f,f&7&&(u=f)}}}function G_(s,e,t,i,n){let r=n==1?2:1;for(let o=0,a=0,l=0;o<=i.length;o++){let c=o?i[o-1].to:e,h=o<i.length?i[o].from:t;for(let u=c,f,d,m;u<h;u++)if(d=ou[f=s.charCodeAt(u)])if(d<0){for(let g=a-3;g>=0;g-=3)if(sn[g+1]==-d){let y=sn[g+2],_=y&2?n:y&4?y&1?r:n:0;_&&(Ne[u]=Ne[sn[g]]=_),a=g;break}}else{if(sn.length==189)break;sn[a++]=u,sn[a++]=f,sn[a++]=l}else if((m=Ne[u])==2||m==1){let g=m==n;l=g?0:1;for(let y=a-3;y>=0;y-=3){let _=sn[y+2];if(_&2)break;if(g)sn[y+2]|=2;else{if(_&4)break;sn[y+2]|=4}}}}}function W_(s,e,t,i){for(let n=0,r=i;n<=t.length;n++){let o=n?t[n-1].to:s,a=n<t.length?t[n].from:e;for(let l=o;l<a;){let c=Ne[l];if(c==256){let h=l+1;for(;;)if(h==a){if(n==t.length)break;h=t[n++].to,a=n<t.length?t[n].from:e}else if(Ne[h]==256)h++;else break;let u=r==1,f=(h<e?Ne[h]:i)==1,d=u==f?u?1:2:i;for(let m=h,g=n,y=g?t[g-1].to:s;m>l;)m==y&&(m=t[--g].from,y=g?t[g-1].to:s),Ne[--m]=d;l=h}else r=c,l++}}}function au(s,e,t,i,n,r,o){let a=i%2?2:1;if(i%2==n%2)for(let l=e,c=0;l<t;){let h=!0,u=!1;if(c==r.length||l<r[c].from){let g=Ne[l];g!=a&&(h=!1,u=g==16)}let f=!h&&a==1?[]:null,d=h?i:i+1,m=l;e:for(;;)if(c<r.length&&m==r[c].from){if(u)break e;let g=r[c];if(!h)for(let y=g.to,_=c+1;;){if(y==t)break e;if(_<r.length&&r[_].from==y)y=r[_++].to;else{if(Ne[y]==a)break e;break}}if(c++,f)f.push(g);else{g.from>l&&o.push(new Si(l,g.from,d));let y=g.direction==br!=!(d%2);lu(s,y?i+1:i,n,g.inner,g.from,g.to,o),l=g.to}m=g.to}else{if(m==t||(h?Ne[m]!=a:Ne[m]==a))break;m++}f?au(s,l,m,i+1,n,f,o):l<m&&o.push(new Si(l,m,d)),l=m}else for(let l=t,c=r.length;l>e;){let h=!0,u=!1;if(!c||l>r[c-1].to){let g=Ne[l-1];g!=a&&(h=!1,u=g==16)}let f=!h&&a==1?[]:null,d=h?i:i+1,m=l;e:for(;;)if(c&&m==r[c-1].to){if(u)break e;let g=r[--c];if(!h)for(let y=g.from,_=c;;){if(y==e)break e;if(_&&r[_-1].to==y)y=r[--_].from;else{if(Ne[y-1]==a)break e;break}}if(f)f.push(g);else{g.to<l&&o.push(new Si(g.to,l,d));let y=g.direction==br!=!(d%2);lu(s,y?i+1:i,n,g.inner,g.from,g.to,o),l=g.from}m=g.from}else{if(m==e||(h?Ne[m-1]!=a:Ne[m-1]==a))break;m--}f?au(s,m,l,i+1,n,f,o):m<l&&o.push(new Si(m,l,d)),l=m}}function lu(s,e,t,i,n,r,o){let a=e%2?2:1;H_(s,n,r,i,a),G_(s,n,r,i,a),W_(n,r,i,a),au(s,n,r,e,t,i,o)}function q_(s,e,t){if(!s)return[new Si(0,0,e==Ku?1:0)];if(e==br&&!t.length&&!V_.test(s))return Mg(s.length);if(t.length)for(;s.length>Ne.length;)Ne[Ne.length]=256;let i=[],n=e==br?0:1;return lu(s,n,n,t,0,s.length,i),i}function Mg(s){return[new Si(0,s,0)]}var Ag="";function X_(s,e,t,i,n){var r;if(!s.length)return null;let o=i.head-s.from,a;if(i.head==s.from&&i.assoc<0){if(!n)return null;o=e[a=0].side(!1,t)}else if(i.head==s.to&&i.assoc>0){if(n)return null;o=e[a=e.length-1].side(!0,t)}else a=Si.find(e,o,(r=i.bidiLevel)!==null&&r!==void 0?r:-1,i.assoc);let l=e[a],c=l.side(n,t);if(o==c){let f=a+=n?1:-1;if(f<0||f>=e.length)return null;l=e[a=f],o=l.side(!n,t),c=l.side(n,t)}let h=nt(s.text,o,l.forward(n,t));(h<l.from||h>l.to)&&(h=c),Ag=s.text.slice(Math.min(o,h),Math.max(o,h));let u=a==(n?e.length-1:0)?null:e[a+(n?1:-1)];if(h==c){if(!u)return n?I.cursor(s.to,1):I.cursor(s.from,-1);if(u.level+(n?0:1)<l.level)return I.cursor(u.side(!n,t)+s.from,u.forward(n,t)?1:-1,u.level)}return I.cursor(h+s.from,l.forward(n,t)?-1:1,l.level)}function $_(s,e,t){for(let i=e;i<t;i++){let n=Sg(s.charCodeAt(i));if(n==1)return br;if(n==2||n==4)return Ku}}var Tg=$.define(),Eg=$.define(),Cg=$.define(),Rg=$.define(),cu=$.define(),Pg=$.define(),kg=$.define(),Ju=$.define(),Zu=$.define(),Lg=$.define({combine:s=>s.some(e=>e)}),Ig=$.define({combine:s=>s.some(e=>e)}),Dg=$.define(),bo=class s{constructor(e,t,i,n,r,o=!1){this.range=e,this.y=t,this.x=i,this.yMargin=n,this.xMargin=r,this.isSnapshot=o}map(e){return e.empty?this:new s(this.range.map(e),this.y,this.x,this.yMargin,this.xMargin,this.isSnapshot)}clip(e){return this.range.to<=e.doc.length?this:new s(I.cursor(e.doc.length),this.y,this.x,this.yMargin,this.xMargin,this.isSnapshot)}},Ua=de.define({map:(s,e)=>s.map(e)}),Ng=de.define();function ii(s,e,t){let i=s.facet(Rg);i.length?i[0](e):window.onerror&&window.onerror(String(e),t,void 0,void 0,e)||(t?console.error(t+":",e):console.error(e))}var xn=$.define({combine:s=>s.length?s[0]:!0}),Y_=0,dr=$.define({combine(s){return s.filter((e,t)=>{for(let i=0;i<t;i++)if(s[i].plugin==e.plugin)return!1;return!0})}}),_t=class s{constructor(e,t,i,n,r){this.id=e,this.create=t,this.domEventHandlers=i,this.domEventObservers=n,this.baseExtensions=r(this),this.extension=this.baseExtensions.concat(dr.of({plugin:this,arg:void 0}))}of(e){return this.baseExtensions.concat(dr.of({plugin:this,arg:e}))}static define(e,t){let{eventHandlers:i,eventObservers:n,provide:r,decorations:o}=t||{};return new s(Y_++,e,i,n,a=>{let l=[];return o&&l.push(gl.of(c=>{let h=c.plugin(a);return h?o(h):oe.none})),r&&l.push(r(a)),l})}static fromClass(e,t){return s.define((i,n)=>new e(i,n),t)}},_o=class{constructor(e){this.spec=e,this.mustUpdate=null,this.value=null}get plugin(){return this.spec&&this.spec.plugin}update(e){if(this.value){if(this.mustUpdate){let t=this.mustUpdate;if(this.mustUpdate=null,this.value.update)try{this.value.update(t)}catch(i){if(ii(t.state,i,"CodeMirror plugin crashed"),this.value.destroy)try{this.value.destroy()}catch{}this.deactivate()}}}else if(this.spec)try{this.value=this.spec.plugin.create(e,this.spec.arg)}catch(t){ii(e.state,t,"CodeMirror plugin crashed"),this.deactivate()}return this}destroy(e){var t;if(!((t=this.value)===null||t===void 0)&&t.destroy)try{this.value.destroy()}catch(i){ii(e.state,i,"CodeMirror plugin crashed")}}deactivate(){this.spec=this.value=null}},Og=$.define(),ju=$.define(),gl=$.define(),Fg=$.define(),Qu=$.define(),ko=$.define(),Bg=$.define();function Fm(s,e){let t=s.state.facet(Bg);if(!t.length)return t;let i=t.map(r=>r instanceof Function?r(s):r),n=[];return Me.spans(i,e.from,e.to,{point(){},span(r,o,a,l){let c=r-e.from,h=o-e.from,u=n;for(let f=a.length-1;f>=0;f--,l--){let d=a[f].spec.bidiIsolate,m;if(l>0&&u.length&&(m=u[u.length-1]).to==c&&m.direction==d)m.to=h,u=m.inner;else{let g={from:c,to:h,direction:d,inner:[]};u.push(g),u=g.inner}}}}),Ug(e.text,n)}function Ug(s,e){for(let t of e){if(t.direction==null){for(let i=t.from,n=0;i<t.to;n++){let r=n<t.inner.length?t.inner[n]:null,o=$_(s,i,r?r.from:t.to);if(o){t.direction=o;break}if(!r)break;i=r.to}t.direction==null&&(t.direction=Ie.LTR)}Ug(s,t.inner)}return e}var zg=$.define();function ef(s){let e=0,t=0,i=0,n=0;for(let r of s.state.facet(zg)){let o=r(s);o&&(o.left!=null&&(e=Math.max(e,o.left)),o.right!=null&&(t=Math.max(t,o.right)),o.top!=null&&(i=Math.max(i,o.top)),o.bottom!=null&&(n=Math.max(n,o.bottom)))}return{left:e,right:t,top:i,bottom:n}}var go=$.define(),Oi=class s{constructor(e,t,i,n){this.fromA=e,this.toA=t,this.fromB=i,this.toB=n}join(e){return new s(Math.min(this.fromA,e.fromA),Math.max(this.toA,e.toA),Math.min(this.fromB,e.fromB),Math.max(this.toB,e.toB))}addToSet(e){let t=e.length,i=this;for(;t>0;t--){let n=e[t-1];if(!(n.fromA>i.toA)){if(n.toA<i.fromA)break;i=i.join(n),e.splice(t-1,1)}}return e.splice(t,0,i),e}static extendWithRanges(e,t){if(t.length==0)return e;let i=[];for(let n=0,r=0,o=0;;){let a=n<e.length?e[n].fromB:1e9,l=r<t.length?t[r]:1e9,c=Math.min(a,l);if(c==1e9)break;let h=c+o,u=c,f=h;for(;;)if(r<t.length&&t[r]<=u){let d=t[r+1];r+=2,u=Math.max(u,d);for(let m=n;m<e.length&&e[m].fromB<=u;m++)o=e[m].toA-e[m].toB;f=Math.max(f,d+o)}else if(n<e.length&&e[n].fromB<=u){let d=e[n++];u=Math.max(u,d.toB),f=Math.max(f,d.toA),o=d.toA-d.toB}else break;i.push(new s(h,f,c,u))}return i}},il=class s{constructor(e,t,i){this.view=e,this.state=t,this.transactions=i,this.flags=0,this.startState=e.state,this.changes=Ut.empty(this.startState.doc.length);for(let r of i)this.changes=this.changes.compose(r.changes);let n=[];this.changes.iterChangedRanges((r,o,a,l)=>n.push(new Oi(r,o,a,l))),this.changedRanges=n}static create(e,t,i){return new s(e,t,i)}get viewportChanged(){return(this.flags&4)>0}get viewportMoved(){return(this.flags&8)>0}get heightChanged(){return(this.flags&2)>0}get geometryChanged(){return this.docChanged||(this.flags&18)>0}get focusChanged(){return(this.flags&1)>0}get docChanged(){return!this.changes.empty}get selectionSet(){return this.transactions.some(e=>e.selection)}get empty(){return this.flags==0&&this.transactions.length==0}},K_=[],Ke=class{constructor(e,t,i=0){this.dom=e,this.length=t,this.flags=i,this.parent=null,e.cmTile=this}get breakAfter(){return this.flags&1}get children(){return K_}isWidget(){return!1}get isHidden(){return!1}isComposite(){return!1}isLine(){return!1}isText(){return!1}isBlock(){return!1}get domAttrs(){return null}sync(e){if(this.flags|=2,this.flags&4){this.flags&=-5;let t=this.domAttrs;t&&L_(this.dom,t)}}toString(){return this.constructor.name+(this.children.length?`(${this.children})`:"")+(this.breakAfter?"#":"")}destroy(){this.parent=null}setDOM(e){this.dom=e,e.cmTile=this}get posAtStart(){return this.parent?this.parent.posBefore(this):0}get posAtEnd(){return this.posAtStart+this.length}posBefore(e,t=this.posAtStart){let i=t;for(let n of this.children){if(n==e)return i;i+=n.length+n.breakAfter}throw new RangeError("Invalid child in posBefore")}posAfter(e){return this.posBefore(e)+e.length}covers(e){return!0}coordsIn(e,t,i){return null}domPosFor(e,t){let i=Fn(this.dom),n=this.length?e>0:t>0;return new rn(this.parent.dom,i+(n?1:0),e==0||e==this.length)}markDirty(e){this.flags&=-3,e&&(this.flags|=4),this.parent&&this.parent.flags&2&&this.parent.markDirty(!1)}get overrideDOMText(){return null}get root(){for(let e=this;e;e=e.parent)if(e instanceof Sr)return e;return null}static get(e){return e.cmTile}},_r=class extends Ke{constructor(e){super(e,0),this._children=[]}isComposite(){return!0}get children(){return this._children}get lastChild(){return this.children.length?this.children[this.children.length-1]:null}append(e){this.children.push(e),e.parent=this}sync(e){if(this.flags&2)return;super.sync(e);let t=this.dom,i=null,n,r=e?.node==t?e:null,o=0;for(let a of this.children){if(a.sync(e),o+=a.length+a.breakAfter,n=i?i.nextSibling:t.firstChild,r&&n!=a.dom&&(r.written=!0),a.dom.parentNode==t)for(;n&&n!=a.dom;)n=Bm(n);else t.insertBefore(a.dom,n);i=a.dom}for(n=i?i.nextSibling:t.firstChild,r&&n&&(r.written=!0);n;)n=Bm(n);this.length=o}};function Bm(s){let e=s.nextSibling;return s.parentNode.removeChild(s),e}var Sr=class extends _r{constructor(e,t){super(t),this.view=e}owns(e){for(;e;e=e.parent)if(e==this)return!0;return!1}isBlock(){return!0}nearest(e){for(;;){if(!e)return null;let t=Ke.get(e);if(t&&this.owns(t))return t;e=e.parentNode}}blockTiles(e){for(let t=[],i=this,n=0,r=0;;)if(n==i.children.length){if(!t.length)return;i=i.parent,i.breakAfter&&r++,n=t.pop()}else{let o=i.children[n++];if(o instanceof vn)t.push(n),i=o,n=0;else{let a=r+o.length,l=e(o,r);if(l!==void 0)return l;r=a+o.breakAfter}}}resolveBlock(e,t){let i,n=-1,r,o=-1;if(this.blockTiles((a,l)=>{let c=l+a.length;if(e>=l&&e<=c){if(a.isWidget()&&t>=-1&&t<=1){if(a.flags&32)return!0;a.flags&16&&(i=void 0)}(l<e||e==c&&(t<-1?a.length:a.covers(1)))&&(!i||!a.isWidget()&&i.isWidget())&&(i=a,n=e-l),(c>e||e==l&&(t>1?a.length:a.covers(-1)))&&(!r||!a.isWidget()&&r.isWidget())&&(r=a,o=e-l)}}),!i&&!r)throw new Error("No tile at position "+e);return i&&t<0||!r?{tile:i,offset:n}:{tile:r,offset:o}}},vn=class s extends _r{constructor(e,t){super(e),this.wrapper=t}isBlock(){return!0}covers(e){return this.children.length?e<0?this.children[0].covers(-1):this.lastChild.covers(1):!1}get domAttrs(){return this.wrapper.attributes}static of(e,t){let i=new s(t||document.createElement(e.tagName),e);return t||(i.flags|=4),i}},wr=class s extends _r{constructor(e,t){super(e),this.attrs=t}isLine(){return!0}static start(e,t,i){let n=new s(t||document.createElement("div"),e);return(!t||!i)&&(n.flags|=4),n}get domAttrs(){return this.attrs}resolveInline(e,t,i=!1){let n=null,r=-1,o=null,a=-1;function l(h,u){for(let f=0,d=0;f<h.children.length&&d<=u;f++){let m=h.children[f],g=d+m.length;g>=u&&(m.isComposite()?l(m,u-d):(!o||i&&o.isHidden&&(t>0&&!(o.flags&32)||i&&Z_(o,m)))&&(g>u||m.flags&32&&t<=1)?(o=m,a=u-d):(d<u||m.flags&16&&!(i&&m.isHidden)&&t>=-1)&&(n=m,r=u-d)),d=g}}l(this,e);let c=(t<0?n:o)||n||o;return c?{tile:c,offset:c==n?r:a}:null}coordsIn(e,t,i){let n=this.resolveInline(e,t,!0);return n?n.tile.coordsIn(Math.max(0,n.offset),t,i):J_(this)}domIn(e,t){let i=this.resolveInline(e,t);if(i){let{tile:n,offset:r}=i;if(this.dom.contains(n.dom))return n.isText()?new rn(n.dom,Math.min(n.dom.nodeValue.length,r)):n.domPosFor(r,n.flags&16?1:n.flags&32?-1:t);let o=i.tile.parent,a=!1;for(let l of o.children){if(a)return new rn(l.dom,0);l==i.tile&&(a=!0)}}return new rn(this.dom,0)}};function J_(s){let e=s.dom.lastChild;if(!e)return s.dom.getBoundingClientRect();let t=Ya(e);return t[t.length-1]||null}function Z_(s,e){let t=s.coordsIn(0,1),i=e.coordsIn(0,1);return t&&i&&i.top<t.bottom}var Yt=class s extends _r{constructor(e,t){super(e),this.mark=t}get domAttrs(){return this.mark.attrs}static of(e,t){let i=new s(t||document.createElement(e.tagName),e);return t||(i.flags|=4),i}},gs=class s extends Ke{constructor(e,t){super(e,t.length),this.text=t}sync(e){this.flags&2||(super.sync(e),this.dom.nodeValue!=this.text&&(e&&e.node==this.dom&&(e.written=!0),this.dom.nodeValue=this.text))}isText(){return!0}toString(){return JSON.stringify(this.text)}coordsIn(e,t,i){let n=this.dom.nodeValue.length;e>n&&(e=n);let r=e,o=e,a=0;e==0&&t<0||e==n&&t>=0?q.chrome||q.gecko||(e?(r--,a=1):o<n&&(o++,a=-1)):t<0?r--:o<n&&o++;let l=Po(this.dom,r,o).getClientRects();if(!l.length)return null;let c=l[(a?a<0:t>=0)?0:l.length-1];return q.safari&&!a&&c.width==0&&(c=Array.prototype.find.call(l,h=>h.width)||c),i==null?c:tl(c,(a?a>0:t<0)==i)}static of(e,t){let i=new s(t||document.createTextNode(e),e);return t||(i.flags|=2),i}},ys=class s extends Ke{constructor(e,t,i,n){super(e,t,n),this.widget=i}isWidget(){return!0}get isHidden(){return this.widget.isHidden}covers(e){return this.flags&48?!1:(this.flags&(e<0?64:128))>0}coordsIn(e,t){return this.coordsInWidget(e,t,!1)}coordsInWidget(e,t,i){let n=this.widget.coordsAt(this.dom,e,t);if(n)return n;if(i)return tl(this.dom.getBoundingClientRect(),this.length?e==0:t<=0);{let r=this.dom.getClientRects(),o=null;if(!r.length)return null;let a=this.flags&16?!0:this.flags&32?!1:e>0;for(let l=a?r.length-1:0;o=r[l],!(e>0?l==0:l==r.length-1||o.top<o.bottom);l+=a?-1:1);return tl(o,!a)}}get overrideDOMText(){if(!this.length)return be.empty;let{root:e}=this;if(!e)return be.empty;let t=this.posAtStart;return e.view.state.doc.slice(t,t+this.length)}destroy(){super.destroy(),this.widget.destroy(this.dom)}static of(e,t,i,n,r){return r||(r=e.toDOM(t),e.editable||(r.contentEditable="false")),new s(r,i,e,n)}},Mr=class extends Ke{constructor(e){let t=document.createElement("img");t.className="cm-widgetBuffer",t.setAttribute("aria-hidden","true"),super(t,0,e)}get isHidden(){return!0}get overrideDOMText(){return be.empty}coordsIn(e,t,i){let n=this.dom.getBoundingClientRect();return i==null?n:tl(n,t>0==i)}},hu=class{constructor(e){this.index=0,this.beforeBreak=!1,this.parents=[],this.tile=e}advance(e,t,i){let{tile:n,index:r,beforeBreak:o,parents:a}=this;for(;e||t>0;)if(n.isComposite())if(o){if(!e)break;i&&i.break(),e--,o=!1}else if(r==n.children.length){if(!e&&!a.length)break;i&&i.leave(n),o=!!n.breakAfter,{tile:n,index:r}=a.pop(),r++}else{let l=n.children[r],c=l.breakAfter;(t>0?l.length<=e:l.length<e)&&(!i||i.skip(l,0,l.length)!==!1||!l.isComposite)?(o=!!c,r++,e-=l.length):(a.push({tile:n,index:r}),n=l,r=0,i&&l.isComposite()&&i.enter(l))}else{let l=n.length;if(r<l&&e){let c=Math.min(e,l-r);i&&i.skip(n,r,r+c),e-=c,r+=c}if(r==l)o=!!n.breakAfter,{tile:n,index:r}=a.pop(),r++;else if(!e)break}return this.tile=n,this.index=r,this.beforeBreak=o,this}get root(){return this.parents.length?this.parents[0].tile:this.tile}},uu=class{constructor(e,t,i,n){this.from=e,this.to=t,this.wrapper=i,this.rank=n}},fu=class{constructor(e,t,i){this.cache=e,this.root=t,this.blockWrappers=i,this.curLine=null,this.lastBlock=null,this.afterWidget=null,this.pos=0,this.wrappers=[],this.wrapperPos=0}addText(e,t,i,n){var r;this.flushBuffer();let o=this.ensureMarks(t,i),a=o.lastChild;if(a&&a.isText()&&!(a.flags&8)&&a.length+e.length<512){this.cache.reused.set(a,2);let l=o.children[o.children.length-1]=new gs(a.dom,a.text+e);l.parent=o}else o.append(n||gs.of(e,(r=this.cache.find(gs))===null||r===void 0?void 0:r.dom));this.pos+=e.length,this.afterWidget=null}addComposition(e,t){let i=this.curLine;i.dom!=t.line.dom&&(i.setDOM(this.cache.reused.has(t.line)?$h(t.line.dom):t.line.dom),this.cache.reused.set(t.line,2));let n=i;for(let a=t.marks.length-1;a>=0;a--){let l=t.marks[a],c=n.lastChild;if(c instanceof Yt&&c.mark.eq(l.mark))c.dom!=l.dom&&c.setDOM($h(l.dom)),n=c;else{let{dom:h}=l;this.cache.reused.get(l)&&Ke.get(l.dom)&&(h=$h(l.dom));let u=Yt.of(l.mark,h);n.append(u),n=u}this.cache.reused.set(l,2)}let r=Ke.get(e.text);r&&this.cache.reused.set(r,2);let o=new gs(e.text,e.text.nodeValue);o.flags|=8,this.pos=e.range.toB,n.append(o)}addInlineWidget(e,t,i){let n=this.afterWidget&&e.flags&48&&(this.afterWidget.flags&48)==(e.flags&48);n||this.flushBuffer();let r=this.ensureMarks(t,i);!n&&!(e.flags&16)&&r.append(this.getBuffer(1)),r.append(e),this.pos+=e.length,this.afterWidget=e}addMark(e,t,i){this.flushBuffer(),this.ensureMarks(t,i).append(e),this.pos+=e.length,this.afterWidget=null}addBlockWidget(e){this.getBlockPos().append(e),this.pos+=e.length,this.lastBlock=e,this.endLine()}continueWidget(e){let t=this.afterWidget||this.lastBlock;t.length+=e,this.pos+=e}addLineStart(e,t){var i;e||(e=Vg);let n=wr.start(e,t||((i=this.cache.find(wr))===null||i===void 0?void 0:i.dom),!!t);this.getBlockPos().append(this.lastBlock=this.curLine=n)}addLine(e){this.getBlockPos().append(e),this.pos+=e.length,this.lastBlock=e,this.endLine()}addBreak(){this.lastBlock.flags|=1,this.endLine(),this.pos++}addLineStartIfNotCovered(e){this.blockPosCovered()||this.addLineStart(e)}ensureLine(e){this.curLine||this.addLineStart(e)}ensureMarks(e,t){var i;let n=this.curLine;for(let r=e.length-1;r>=0;r--){let o=e[r],a;if(t>0&&(a=n.lastChild)&&a instanceof Yt&&a.mark.eq(o))n=a,t--;else{let l=Yt.of(o,(i=this.cache.find(Yt,c=>c.mark.eq(o)))===null||i===void 0?void 0:i.dom);n.append(l),n=l,t=0}}return n}endLine(){if(this.curLine){this.flushBuffer();let e=this.curLine.lastChild;(!e||!Um(this.curLine,!1)||e.dom.nodeName!="BR"&&e.isWidget()&&!(q.ios&&Um(this.curLine,!0)))&&this.curLine.append(this.cache.findWidget(Yh,0,32)||new ys(Yh.toDOM(),0,Yh,32)),this.curLine=this.afterWidget=null}}updateBlockWrappers(){this.wrapperPos>this.pos+1e4&&(this.blockWrappers.goto(this.pos),this.wrappers.length=0);for(let e=this.wrappers.length-1;e>=0;e--)this.wrappers[e].to<this.pos&&this.wrappers.splice(e,1);for(let e=this.blockWrappers;e.value&&e.from<=this.pos;e.next())if(e.to>=this.pos){let t=e.rank*102+e.value.rank,i=new uu(e.from,e.to,e.value,t),n=this.wrappers.length;for(;n>0&&(this.wrappers[n-1].rank-i.rank||this.wrappers[n-1].to-i.to)<0;)n--;this.wrappers.splice(n,0,i)}this.wrapperPos=this.pos}getBlockPos(){var e;this.updateBlockWrappers();let t=this.root;for(let i of this.wrappers){let n=t.lastChild;if(i.from<this.pos&&n instanceof vn&&n.wrapper.eq(i.wrapper))t=n;else{let r=vn.of(i.wrapper,(e=this.cache.find(vn,o=>o.wrapper.eq(i.wrapper)))===null||e===void 0?void 0:e.dom);t.append(r),t=r}}return t}blockPosCovered(){let e=this.lastBlock;return e!=null&&!e.breakAfter&&(!e.isWidget()||(e.flags&160)>0)}getBuffer(e){let t=2|(e<0?16:32),i=this.cache.find(Mr,void 0,1);return i&&(i.flags=t),i||new Mr(t)}flushBuffer(){this.afterWidget&&!(this.afterWidget.flags&32)&&(this.afterWidget.parent.append(this.getBuffer(-1)),this.afterWidget=null)}},du=class{constructor(e){this.skipCount=0,this.text="",this.textOff=0,this.cursor=e.iter()}skip(e){this.textOff+e<=this.text.length?this.textOff+=e:(this.skipCount+=e-(this.text.length-this.textOff),this.text="",this.textOff=0)}next(e){if(this.textOff==this.text.length){let{value:n,lineBreak:r,done:o}=this.cursor.next(this.skipCount);if(this.skipCount=0,o)throw new Error("Ran out of text content when drawing inline views");this.text=n;let a=this.textOff=Math.min(e,n.length);return r?null:n.slice(0,a)}let t=Math.min(this.text.length,this.textOff+e),i=this.text.slice(this.textOff,t);return this.textOff=t,i}},nl=[ys,wr,gs,Yt,Mr,vn,Sr];for(let s=0;s<nl.length;s++)nl[s].bucket=s;var pu=class{constructor(e){this.view=e,this.buckets=nl.map(()=>[]),this.index=nl.map(()=>0),this.reused=new Map}add(e){let t=e.constructor.bucket,i=this.buckets[t];i.length<6?i.push(e):i[this.index[t]=(this.index[t]+1)%6]=e}find(e,t,i=2){let n=e.bucket,r=this.buckets[n],o=this.index[n];for(let a=0;a<r.length;a++){let l=(a+o)%r.length,c=r[l];if((!t||t(c))&&!this.reused.has(c))return r.splice(l,1),l<o&&this.index[n]--,this.reused.set(c,i),c}return null}findWidget(e,t,i){let n=this.buckets[0];if(n.length)for(let r=0,o=0;;r++){if(r==n.length){if(o)return null;o=1,r=0}let a=n[r];if(!this.reused.has(a)&&(o==0?a.widget.compare(e):a.widget.constructor==e.constructor&&e.updateDOM(a.dom,this.view,a.widget)))return n.splice(r,1),r<this.index[0]&&this.index[0]--,a.widget==e&&a.length==t&&(a.flags&497)==i?(this.reused.set(a,1),a):(this.reused.set(a,2),new ys(a.dom,t,e,a.flags&-498|i))}}reuse(e){return this.reused.set(e,1),e}maybeReuse(e,t=2){if(!this.reused.has(e))return this.reused.set(e,t),e.dom}clear(){for(let e=0;e<this.buckets.length;e++)this.buckets[e].length=this.index[e]=0}},mu=class{constructor(e,t,i,n,r){this.view=e,this.decorations=n,this.disallowBlockEffectsFor=r,this.openWidget=!1,this.openMarks=0,this.cache=new pu(e),this.text=new du(e.state.doc),this.builder=new fu(this.cache,new Sr(e,e.contentDOM),Me.iter(i)),this.cache.reused.set(t,2),this.old=new hu(t),this.reuseWalker={skip:(o,a,l)=>{if(this.cache.add(o),o.isComposite())return!1},enter:o=>this.cache.add(o),leave:()=>{},break:()=>{}}}run(e,t){let i=t&&this.getCompositionContext(t.text);for(let n=0,r=0,o=0;;){let a=o<e.length?e[o++]:null,l=a?a.fromA:this.old.root.length;if(l>n){let c=l-n;this.preserve(c,!o,!a),n=l,r+=c}if(!a)break;t&&a.fromA<=t.range.fromA&&a.toA>=t.range.toA?(this.forward(a.fromA,t.range.fromA,t.range.fromA<t.range.toA?1:-1),this.emit(r,t.range.fromB),this.builder.flushBuffer(),this.cache.clear(),this.builder.addComposition(t,i),this.text.skip(t.range.toB-t.range.fromB),this.forward(t.range.fromA,a.toA),this.emit(t.range.toB,a.toB)):(this.forward(a.fromA,a.toA),this.emit(r,a.toB)),r=a.toB,n=a.toA}return this.builder.curLine&&this.builder.endLine(),this.builder.root}preserve(e,t,i){let n=eS(this.old),r=this.openMarks;this.old.advance(e,i?1:-1,{skip:(o,a,l)=>{if(o.isWidget())if(this.openWidget)this.builder.continueWidget(l-a);else{let c=l>0||a<o.length?ys.of(o.widget,this.view,l-a,o.flags&496,this.cache.maybeReuse(o)):this.cache.reuse(o);c.flags&256?(c.flags&=-2,this.builder.addBlockWidget(c)):(this.builder.ensureLine(null),this.builder.addInlineWidget(c,n,r),r=n.length)}else if(o.isText())this.builder.ensureLine(null),!a&&l==o.length&&!this.cache.reused.has(o)?this.builder.addText(o.text,n,r,this.cache.reuse(o)):(this.cache.add(o),this.builder.addText(o.text.slice(a,l),n,r)),r=n.length;else if(o.isLine())o.flags&=-2,this.cache.reused.set(o,1),this.builder.addLine(o);else if(o instanceof Mr)this.cache.add(o);else if(o instanceof Yt)this.builder.ensureLine(null),this.builder.addMark(o,n,r),this.cache.reused.set(o,1),r=n.length;else return!1;this.openWidget=!1},enter:o=>{o.isLine()?this.builder.addLineStart(o.attrs,this.cache.maybeReuse(o)):(this.cache.add(o),o instanceof Yt&&n.unshift(o.mark)),this.openWidget=!1},leave:o=>{o.isLine()?n.length&&(n.length=r=0):o instanceof Yt&&(n.shift(),r=Math.min(r,n.length))},break:()=>{this.builder.addBreak(),this.openWidget=!1}}),this.text.skip(e)}emit(e,t){let i=null,n=this.builder,r=-1,o=Me.spans(this.decorations,e,t,{point:(a,l,c,h,u,f)=>{if(c instanceof vs){if(this.disallowBlockEffectsFor[f]){if(c.block)throw new RangeError("Block decorations may not be specified via plugins");if(l>this.view.state.doc.lineAt(a).to)throw new RangeError("Decorations that replace line breaks may not be specified via plugins")}if(r=h.length,u>h.length)n.continueWidget(l-a);else{let d=c.widget||(c.block?Bn.block:Bn.inline),m=j_(c),g=this.cache.findWidget(d,l-a,m)||ys.of(d,this.view,l-a,m);c.block?(c.startSide>0&&n.addLineStartIfNotCovered(i),n.addBlockWidget(g)):(n.ensureLine(i),n.addInlineWidget(g,h,u))}i=null}else i=Q_(i,c);l>a&&this.text.skip(l-a)},span:(a,l,c,h)=>{for(let u=a;u<l;){let f=this.text.next(Math.min(512,l-u));f==null?(n.addLineStartIfNotCovered(i),n.addBreak(),u++):(n.ensureLine(i),n.addText(f,c,u==a?h:c.length),u+=f.length),i=null}r=c.length}});r>-1&&(this.openWidget=o>r),this.openWidget||n.addLineStartIfNotCovered(i),this.openMarks=o}forward(e,t,i=1){t-e<=10?this.old.advance(t-e,i,this.reuseWalker):(this.old.advance(5,-1,this.reuseWalker),this.old.advance(t-e-10,-1),this.old.advance(5,i,this.reuseWalker))}getCompositionContext(e){let t=[],i=null;for(let n=e.parentNode;;n=n.parentNode){let r=Ke.get(n);if(n==this.view.contentDOM)break;r instanceof Yt?t.push(r):r?.isLine()?i=r:r instanceof vn||(n.nodeName=="DIV"&&!i?i=new wr(n,Vg):i||t.push(Yt.of(new Eo({tagName:n.nodeName.toLowerCase(),attributes:I_(n)}),n)))}return i?{line:i,marks:t}:null}};function Um(s,e){let t=i=>{for(let n of i.children)if((e?n.isText():n.length)||t(n))return!0;return!1};return t(s)}function j_(s){let e=s.isReplace?(s.startSide<0?64:0)|(s.endSide>0?128:0):s.startSide>0?32:16;return s.block&&(e|=256),e}var Vg={class:"cm-line"};function Q_(s,e){let t=e.spec.attributes,i=e.spec.class;return!t&&!i||(s||(s={class:"cm-line"}),t&&$u(t,s),i&&(s.class+=" "+i)),s}function eS(s){let e=[];for(let t=s.parents.length;t>1;t--){let i=t==s.parents.length?s.tile:s.parents[t].tile;i instanceof Yt&&e.push(i.mark)}return e}function $h(s){let e=Ke.get(s);return e&&e.setDOM(s.cloneNode()),s}var Bn=class extends yn{constructor(e){super(),this.tag=e}eq(e){return e.tag==this.tag}toDOM(){return document.createElement(this.tag)}updateDOM(e){return e.nodeName.toLowerCase()==this.tag}get isHidden(){return!0}};Bn.inline=new Bn("span");Bn.block=new Bn("div");var Yh=new class extends yn{toDOM(){return document.createElement("br")}get isHidden(){return!0}get editable(){return!0}},sl=class{constructor(e){this.view=e,this.decorations=[],this.blockWrappers=[],this.dynamicDecorationMap=[!1],this.domChanged=null,this.hasComposition=null,this.editContextFormatting=oe.none,this.lastCompositionAfterCursor=!1,this.minWidth=0,this.minWidthFrom=0,this.minWidthTo=0,this.impreciseAnchor=null,this.impreciseHead=null,this.forceSelection=!1,this.lastUpdate=Date.now(),this.updateDeco(),this.tile=new Sr(e,e.contentDOM),this.updateInner([new Oi(0,0,0,e.state.doc.length)],null)}update(e){var t;let i=e.changedRanges;this.minWidth>0&&i.length&&(i.every(({fromA:h,toA:u})=>u<this.minWidthFrom||h>this.minWidthTo)?(this.minWidthFrom=e.changes.mapPos(this.minWidthFrom,1),this.minWidthTo=e.changes.mapPos(this.minWidthTo,1)):this.minWidth=this.minWidthFrom=this.minWidthTo=0),this.updateEditContextFormatting(e);let n=-1;this.view.inputState.composing>=0&&!this.view.observer.editContext&&(!((t=this.domChanged)===null||t===void 0)&&t.newSel?n=this.domChanged.newSel.head:!lS(e.changes,this.hasComposition)&&!e.selectionSet&&(n=e.state.selection.main.head));let r=n>-1?iS(this.view,e.changes,n):null;if(this.domChanged=null,this.hasComposition){let{from:h,to:u}=this.hasComposition;i=new Oi(h,u,e.changes.mapPos(h,-1),e.changes.mapPos(u,1)).addToSet(i.slice())}this.hasComposition=r?{from:r.range.fromB,to:r.range.toB}:null,(q.ie||q.chrome)&&!r&&e&&e.state.doc.lines!=e.startState.doc.lines&&(this.forceSelection=!0);let o=this.decorations,a=this.blockWrappers;this.updateDeco();let l=rS(o,this.decorations,e.changes);l.length&&(i=Oi.extendWithRanges(i,l));let c=oS(a,this.blockWrappers,e.changes);return c.length&&(i=Oi.extendWithRanges(i,c)),r&&!i.some(h=>h.fromA<=r.range.fromA&&h.toA>=r.range.toA)&&(i=r.range.addToSet(i.slice())),this.tile.flags&2&&i.length==0?!1:(this.updateInner(i,r),e.transactions.length&&(this.lastUpdate=Date.now()),!0)}updateInner(e,t){this.view.viewState.mustMeasureContent=!0;let{observer:i}=this.view;i.ignore(()=>{if(t||e.length){let o=this.tile,a=new mu(this.view,o,this.blockWrappers,this.decorations,this.dynamicDecorationMap);t&&Ke.get(t.text)&&a.cache.reused.set(Ke.get(t.text),2),this.tile=a.run(e,t),gu(o,a.cache.reused)}this.tile.dom.style.height=this.view.viewState.contentHeight/this.view.scaleY+"px",this.tile.dom.style.flexBasis=this.minWidth?this.minWidth+"px":"";let r=q.chrome||q.ios?{node:i.selectionRange.focusNode,written:!1}:void 0;this.tile.sync(r),r&&(r.written||i.selectionRange.focusNode!=r.node||!this.tile.dom.contains(r.node))&&(this.forceSelection=!0),this.tile.dom.style.height=""});let n=[];if(this.view.viewport.from||this.view.viewport.to<this.view.state.doc.length)for(let r of this.tile.children)r.isWidget()&&r.widget instanceof So&&n.push(r.dom);i.updateGaps(n)}updateEditContextFormatting(e){this.editContextFormatting=this.editContextFormatting.map(e.changes);for(let t of e.transactions)for(let i of t.effects)i.is(Ng)&&(this.editContextFormatting=i.value)}updateSelection(e=!1,t=!1){(e||!this.view.observer.selectionRange.focusNode)&&this.view.observer.readSelectionRange();let{dom:i}=this.tile,n=this.view.root.activeElement,r=n==i,o=!r&&!(this.view.state.facet(xn)||i.tabIndex>-1)&&vo(i,this.view.observer.selectionRange)&&!(n&&i.contains(n));if(!(r||t||o))return;let a=this.forceSelection;this.forceSelection=!1;let l=this.view.state.selection.main,c,h;if(l.empty?h=c=this.inlineDOMNearPos(l.anchor,l.assoc||1):(h=this.inlineDOMNearPos(l.head,l.head==l.from?1:-1),c=this.inlineDOMNearPos(l.anchor,l.anchor==l.from?1:-1)),q.gecko&&l.empty&&!this.hasComposition&&tS(c)){let f=document.createTextNode("");this.view.observer.ignore(()=>c.node.insertBefore(f,c.node.childNodes[c.offset]||null)),c=h=new rn(f,0),a=!0}let u=this.view.observer.selectionRange;(a||!u.focusNode||(!yo(c.node,c.offset,u.anchorNode,u.anchorOffset)||!yo(h.node,h.offset,u.focusNode,u.focusOffset))&&!this.suppressWidgetCursorChange(u,l))&&(this.view.observer.ignore(()=>{q.android&&q.chrome&&i.contains(u.focusNode)&&aS(u.focusNode,i)&&(i.blur(),i.focus({preventScroll:!0}));let f=Ro(this.view.root);if(f)if(l.empty){if(q.gecko){let d=nS(c.node,c.offset);if(d&&d!=3){let m=(d==1?yg:bg)(c.node,c.offset);m&&(c=new rn(m.node,m.offset))}}f.collapse(c.node,c.offset),l.bidiLevel!=null&&f.caretBidiLevel!==void 0&&(f.caretBidiLevel=l.bidiLevel)}else if(f.extend){f.collapse(c.node,c.offset);try{f.extend(h.node,h.offset)}catch{}}else{let d=document.createRange();l.anchor>l.head&&([c,h]=[h,c]),d.setEnd(h.node,h.offset),d.setStart(c.node,c.offset),f.removeAllRanges(),f.addRange(d)}o&&this.view.root.activeElement==i&&(i.blur(),n&&n.focus())}),this.view.observer.setSelectionRange(c,h)),this.impreciseAnchor=c.precise?null:new rn(u.anchorNode,u.anchorOffset),this.impreciseHead=h.precise?null:new rn(u.focusNode,u.focusOffset)}suppressWidgetCursorChange(e,t){return this.hasComposition&&t.empty&&yo(e.focusNode,e.focusOffset,e.anchorNode,e.anchorOffset)&&this.posFromDOM(e.focusNode,e.focusOffset)==t.head}enforceCursorAssoc(){if(this.hasComposition)return;let{view:e}=this,t=e.state.selection.main,i=Ro(e.root),{anchorNode:n,anchorOffset:r}=e.observer.selectionRange;if(!i||!t.empty||!t.assoc||!i.modify)return;let o=this.lineAt(t.head,t.assoc);if(!o)return;let a=o.posAtStart;if(t.head==a||t.head==a+o.length)return;let l=this.coordsAt(t.head,-1),c=this.coordsAt(t.head,1);if(!l||!c||l.bottom>c.top)return;let h=this.domAtPos(t.head+t.assoc,t.assoc);i.collapse(h.node,h.offset),i.modify("move",t.assoc<0?"forward":"backward","lineboundary"),e.observer.readSelectionRange();let u=e.observer.selectionRange;e.docView.posFromDOM(u.anchorNode,u.anchorOffset)!=t.from&&i.collapse(n,r)}posFromDOM(e,t){let i=this.tile.nearest(e);if(!i)return this.tile.dom.compareDocumentPosition(e)&2?0:this.view.state.doc.length;let n=i.posAtStart;if(i.isComposite()){let r;if(e==i.dom)r=i.dom.childNodes[t];else{let o=bn(e)==0?0:t==0?-1:1;for(;;){let a=e.parentNode;if(a==i.dom)break;o==0&&a.firstChild!=a.lastChild&&(e==a.firstChild?o=-1:o=1),e=a}o<0?r=e:r=e.nextSibling}if(r==i.dom.firstChild)return n;for(;r&&!Ke.get(r);)r=r.nextSibling;if(!r)return n+i.length;for(let o=0,a=n;;o++){let l=i.children[o];if(l.dom==r)return a;a+=l.length+l.breakAfter}}else return i.isText()?e==i.dom?n+t:n+(t?i.length:0):n}domAtPos(e,t){let{tile:i,offset:n}=this.tile.resolveBlock(e,t);return i.isWidget()?i.domPosFor(n,t):i.domIn(n,t)}inlineDOMNearPos(e,t){let i,n=-1,r=!1,o,a=-1,l=!1;return this.tile.blockTiles((c,h)=>{if(c.isWidget()){if(c.flags&32&&h>=e)return!0;c.flags&16&&(r=!0)}else{let u=h+c.length;if(h<=e&&(i=c,n=e-h,r=u<e),u>=e&&!o&&(o=c,a=e-h,l=h>e),h>e&&o)return!0}}),!i&&!o?this.domAtPos(e,t):(r&&o?i=null:l&&i&&(o=null),i&&t<0||!o?i.domIn(n,t):o.domIn(a,t))}coordsAt(e,t,i){let{tile:n,offset:r}=this.tile.resolveBlock(e,t);return n.isWidget()?n.widget instanceof So?null:n.coordsInWidget(r,t,!0):n.coordsIn(r,t,i)}lineAt(e,t){let{tile:i}=this.tile.resolveBlock(e,t);return i.isLine()?i:null}coordsForChar(e){let{tile:t,offset:i}=this.tile.resolveBlock(e,1);if(!t.isLine())return null;function n(r,o){if(r.isComposite())for(let a of r.children){if(a.length>=o){let l=n(a,o);if(l)return l}if(o-=a.length,o<0)break}else if(r.isText()&&o<r.length){let a=nt(r.text,o);if(a==o)return null;let l=Po(r.dom,o,a).getClientRects();for(let c=0;c<l.length;c++){let h=l[c];if(c==l.length-1||h.top<h.bottom&&h.left<h.right)return h}}return null}return n(t,i)}measureVisibleLineHeights(e){let t=[],{from:i,to:n}=e,r=this.view.contentDOM.clientWidth,o=r>Math.max(this.view.scrollDOM.clientWidth,this.minWidth)+1,a=-1,l=this.view.textDirection==Ie.LTR,c=0,h=(u,f,d)=>{for(let m=0;m<u.children.length&&!(f>n);m++){let g=u.children[m],y=f+g.length,_=g.dom.getBoundingClientRect(),{height:w}=_;if(d&&!m&&(c+=_.top-d.top),g instanceof vn)y>i&&h(g,f,_);else if(f>=i&&(c>0&&t.push(-c),t.push(w+c),c=0,o)){let A=g.dom.lastChild,T=A?Ya(A):[];if(T.length){let C=T[T.length-1],E=l?C.right-_.left:_.right-C.left;E>a&&(a=E,this.minWidth=r,this.minWidthFrom=f,this.minWidthTo=y)}}d&&m==u.children.length-1&&(c+=d.bottom-_.bottom),f=y+g.breakAfter}};return h(this.tile,0,null),t}textDirectionAt(e){let{tile:t}=this.tile.resolveBlock(e,1);return getComputedStyle(t.dom).direction=="rtl"?Ie.RTL:Ie.LTR}measureTextSize(){let e=this.tile.blockTiles(o=>{if(o.isLine()&&o.children.length&&o.length<=20){let a=0,l;for(let c of o.children){if(!c.isText()||/[^ -~]/.test(c.text))return;let h=Ya(c.dom);if(h.length!=1)return;a+=h[0].width,l=h[0].height}if(a)return{lineHeight:o.dom.getBoundingClientRect().height,charWidth:a/o.length,textHeight:l}}});if(e)return e;let t=document.createElement("div"),i,n,r;return t.className="cm-line",t.style.width="99999px",t.style.position="absolute",t.textContent="abc def ghi jkl mno pqr stu",this.view.observer.ignore(()=>{this.tile.dom.appendChild(t);let o=Ya(t.firstChild)[0];i=t.getBoundingClientRect().height,n=o&&o.width?o.width/27:7,r=o&&o.height?o.height:i,t.remove()}),{lineHeight:i,charWidth:n,textHeight:r}}computeBlockGapDeco(){let e=[],t=this.view.viewState;for(let i=0,n=0;;n++){let r=n==t.viewports.length?null:t.viewports[n],o=r?r.from-1:this.view.state.doc.length;if(o>i){let a=(t.lineBlockAt(o).bottom-t.lineBlockAt(i).top)/this.view.scaleY;e.push(oe.replace({widget:new So(a),block:!0,inclusive:!0,isBlockGap:!0}).range(i,o))}if(!r)break;i=r.to+1}return oe.set(e)}updateDeco(){let e=1,t=this.view.state.facet(gl).map(r=>(this.dynamicDecorationMap[e++]=typeof r=="function")?r(this.view):r),i=!1,n=this.view.state.facet(Qu).map((r,o)=>{let a=typeof r=="function";return a&&(i=!0),a?r(this.view):r});for(n.length&&(this.dynamicDecorationMap[e++]=i,t.push(Me.join(n))),this.decorations=[this.editContextFormatting,...t,this.computeBlockGapDeco(),this.view.viewState.lineGapDeco];e<this.decorations.length;)this.dynamicDecorationMap[e++]=!1;this.blockWrappers=this.view.state.facet(Fg).map(r=>typeof r=="function"?r(this.view):r)}scrollIntoView(e){if(e.isSnapshot){let c=this.view.viewState.lineBlockAt(e.range.head);this.view.scrollDOM.scrollTop=c.top-e.yMargin,this.view.scrollDOM.scrollLeft=e.xMargin;return}for(let c of this.view.state.facet(Dg))try{if(c(this.view,e.range,e))return!0}catch(h){ii(this.view.state,h,"scroll handler")}let{range:t}=e,i=this.coordsAt(t.head,t.assoc||(t.head>t.anchor?-1:1)),n;if(!i)return;!t.empty&&(n=this.coordsAt(t.anchor,t.anchor>t.head?-1:1))&&(i={left:Math.min(i.left,n.left),top:Math.min(i.top,n.top),right:Math.max(i.right,n.right),bottom:Math.max(i.bottom,n.bottom)});let r=ef(this.view),o={left:i.left-r.left,top:i.top-r.top,right:i.right+r.right,bottom:i.bottom+r.bottom},{offsetWidth:a,offsetHeight:l}=this.view.scrollDOM;if(O_(this.view.scrollDOM,o,t.head<t.anchor?-1:1,e.x,e.y,Math.max(Math.min(e.xMargin,a),-a),Math.max(Math.min(e.yMargin,l),-l),this.view.textDirection==Ie.LTR),window.visualViewport&&window.innerHeight-window.visualViewport.height>1&&(i.top>window.visualViewport.offsetTop+window.visualViewport.height||i.bottom<window.visualViewport.offsetTop)){let c=this.view.docView.lineAt(t.head,1);if(c){let h=mg(c.dom);c.dom.scrollIntoView({block:"nearest"}),gg(h,!1)}}}lineHasWidget(e){let t=i=>i.isWidget()||i.children.some(t);return t(this.tile.resolveBlock(e,1).tile)}destroy(){gu(this.tile)}};function gu(s,e){let t=e?.get(s);if(t!=1){t==null&&s.destroy();for(let i of s.children)gu(i,e)}}function tS(s){return bt(s.node)&&s.node.firstChild&&(s.offset==0||s.node.childNodes[s.offset-1].contentEditable=="false")&&(s.offset==s.node.childNodes.length||s.node.childNodes[s.offset].contentEditable=="false")}function Hg(s,e){let t=s.observer.selectionRange;if(!t.focusNode)return null;let i=yg(t.focusNode,t.focusOffset),n=bg(t.focusNode,t.focusOffset),r=i||n;if(n&&i&&n.node!=i.node){let a=Ke.get(n.node);if(!a||a.isText()&&a.text!=n.node.nodeValue)r=n;else if(s.docView.lastCompositionAfterCursor){let l=Ke.get(i.node);!l||l.isText()&&l.text!=i.node.nodeValue||(r=n)}}if(s.docView.lastCompositionAfterCursor=r!=i,!r)return null;let o=e-r.offset;return{from:o,to:o+r.node.nodeValue.length,node:r.node}}function iS(s,e,t){let i=Hg(s,t);if(!i)return null;let{node:n,from:r,to:o}=i,a=n.nodeValue;if(/[\n\r]/.test(a)||s.state.doc.sliceString(i.from,i.to)!=a)return null;let l=e.invertedDesc;return{range:new Oi(l.mapPos(r),l.mapPos(o),r,o),text:n}}function nS(s,e){return bt(s)?(e&&s.childNodes[e-1].contentEditable=="false"?1:0)|(e<s.childNodes.length&&s.childNodes[e].contentEditable=="false"?2:0):0}var sS=class{constructor(){this.changes=[]}compareRange(e,t){xr(e,t,this.changes)}comparePoint(e,t){xr(e,t,this.changes)}boundChange(e){xr(e,e,this.changes)}};function rS(s,e,t){let i=new sS;return Me.compare(s,e,t,i),i.changes}var xu=class{constructor(){this.changes=[]}compareRange(e,t){xr(e,t,this.changes)}comparePoint(){}boundChange(e){xr(e,e,this.changes)}};function oS(s,e,t){let i=new xu;return Me.compare(s,e,t,i),i.changes}function aS(s,e){for(let t=s;t&&t!=e;t=t.assignedSlot||t.parentNode)if(bt(t)&&t.contentEditable=="false")return!0;return!1}function lS(s,e){let t=!1;return e&&s.iterChangedRanges((i,n)=>{i<e.to&&n>e.from&&(t=!0)}),t}var So=class extends yn{constructor(e){super(),this.height=e}toDOM(){let e=document.createElement("div");return e.className="cm-gap",this.updateDOM(e),e}eq(e){return e.height==this.height}updateDOM(e){return e.style.height=this.height+"px",!0}get editable(){return!0}get estimatedHeight(){return this.height}ignoreEvent(){return!1}};function cS(s,e,t=1){let i=s.charCategorizer(e),n=s.doc.lineAt(e),r=e-n.from;if(n.length==0)return I.cursor(e);r==0?t=1:r==n.length&&(t=-1);let o=r,a=r;t<0?o=nt(n.text,r,!1):a=nt(n.text,r);let l=i(n.text.slice(o,a));for(;o>0;){let c=nt(n.text,o,!1);if(i(n.text.slice(c,o))!=l)break;o=c}for(;a<n.length;){let c=nt(n.text,a);if(i(n.text.slice(a,c))!=l)break;a=c}return I.undirectionalRange(o+n.from,a+n.from)}function hS(s,e,t,i,n){let r=Math.round((i-e.left)*s.defaultCharacterWidth);if(s.lineWrapping&&t.height>s.defaultLineHeight*1.5){let a=s.viewState.heightOracle.textHeight,l=Math.floor((n-t.top-(s.defaultLineHeight-a)*.5)/a);r+=l*s.viewState.heightOracle.lineLength}let o=s.state.sliceDoc(t.from,t.to);return t.from+Am(o,r,s.state.tabSize)}function vu(s,e,t){let i=s.lineBlockAt(e);if(Array.isArray(i.type)){let n;for(let r of i.type){if(r.from>e)break;if(!(r.to<e)){if(r.from<e&&r.to>e)return r;(!n||r.type==Tt.Text&&(n.type!=r.type||(t<0?r.from<e:r.to>e)))&&(n=r)}}return n||i}return i}function uS(s,e,t,i){let n=vu(s,e.head,e.assoc||-1),r=!i||n.type!=Tt.Text||!(s.lineWrapping||n.widgetLineBreaks)?null:s.coordsAtPos(e.assoc<0&&e.head>n.from?e.head-1:e.head);if(r){let o=s.dom.getBoundingClientRect(),a=s.textDirectionAt(n.from),l=s.posAndSideAtCoords({x:t==(a==Ie.LTR)?o.right-1:o.left+1,y:(r.top+r.bottom)/2});if(l)return I.cursor(l.pos,l.assoc)}return I.cursor(t?n.to:n.from,t?1:-1)}function zm(s,e,t,i){let n=s.state.doc.lineAt(e.head),r=s.bidiSpans(n),o=s.textDirectionAt(n.from);for(let a=e,l=null;;){let c=X_(n,r,o,a,t),h=Ag;if(!c){if(n.number==(t?s.state.doc.lines:1))return a;h=`
`,n=s.state.doc.line(n.number+(t?1:-1)),r=s.bidiSpans(n),c=t?I.cursor(n.from,-1):I.cursor(n.to,1)}if(l){if(!l(h))return a}else{if(!i)return c;l=i(h)}a=c}}function fS(s,e,t){let i=s.state.charCategorizer(e),n=i(t);return r=>{let o=i(r);return n==Ye.Space&&(n=o),n==o}}function dS(s,e,t,i){let n=e.head,r=t?1:-1;if(n==(t?s.state.doc.length:0))return I.cursor(n,e.assoc);let o=e.goalColumn,a,l=s.contentDOM.getBoundingClientRect(),c=s.coordsAtPos(n,e.assoc||((e.empty?t:e.head==e.from)?1:-1)),h=s.documentTop;if(c)o==null&&(o=c.left-l.left),a=r<0?c.top:c.bottom;else{let m=s.viewState.lineBlockAt(n);o==null&&(o=Math.min(l.right-l.left,s.defaultCharacterWidth*(n-m.from))),a=(r<0?m.top:m.bottom)+h}let u=l.left+o,f=s.viewState.heightOracle.textHeight>>1,d=i??f;for(let m=0;;m+=f){let g=a+(d+m)*r,y=yu(s,{x:u,y:g},!1,r);if(t?g>l.bottom:g<l.top)return I.cursor(y.pos,y.assoc);let _=s.coordsAtPos(y.pos,y.assoc),w=_?(_.top+_.bottom)/2:0;if(!_||(t?w>a:w<a))return I.cursor(y.pos,y.assoc,void 0,o)}}function wo(s,e,t){for(;;){let i=0;for(let n of s)n.between(e-1,e+1,(r,o,a)=>{if(e>r&&e<o){let l=i||t||(e-r<o-e?-1:1);e=l<0?r:o,i=l}});if(!i)return e}}function Gg(s,e){let t=null;for(let i=0;i<e.ranges.length;i++){let n=e.ranges[i],r=null;if(n.empty){let o=wo(s,n.from,0);o!=n.from&&(r=I.cursor(o,-1))}else{let o=wo(s,n.from,-1),a=wo(s,n.to,1);(o!=n.from||a!=n.to)&&(n.undirectional?r=I.undirectionalRange(n.from,n.to):r=I.range(n.from==n.anchor?o:a,n.from==n.head?o:a))}r&&(t||(t=e.ranges.slice()),t[i]=r)}return t?I.create(t,e.mainIndex):e}function Kh(s,e,t){let i=wo(s.state.facet(ko).map(n=>n(s)),t.from,e.head>t.from?-1:1);return i==t.from?t:I.cursor(i,i<t.from?1:-1)}var _i=class{constructor(e,t){this.pos=e,this.assoc=t}};function yu(s,e,t,i){let n=s.contentDOM.getBoundingClientRect(),r=n.top+s.viewState.paddingTop,{x:o,y:a}=e,l=a-r,c;for(;;){if(l<0)return new _i(0,1);if(l>s.viewState.docHeight)return new _i(s.state.doc.length,-1);if(c=s.elementAtHeight(l),i==null)break;if(c.type==Tt.Text){if(i<0?c.to<s.viewport.from:c.from>s.viewport.to)break;let f=s.docView.coordsAt(i<0?c.from:c.to,i>0?-1:1);if(f&&(i<0?f.top<=l+r:f.bottom>=l+r))break}let u=s.viewState.heightOracle.textHeight/2;l=i>0?c.bottom+u:c.top-u}if(s.viewport.from>=c.to||s.viewport.to<=c.from){if(t)return null;if(c.type==Tt.Text){let u=hS(s,n,c,o,a);return new _i(u,u==c.from?1:-1)}}if(c.type!=Tt.Text)return l<(c.top+c.bottom)/2?new _i(c.from,1):new _i(c.to,-1);let h=s.docView.lineAt(c.from,2);return(!h||h.length!=c.length)&&(h=s.docView.lineAt(c.from,-2)),new bu(s,o,a,s.textDirectionAt(c.from)).scanTile(h,c.from)}var bu=class{constructor(e,t,i,n){this.view=e,this.x=t,this.y=i,this.baseDir=n,this.line=null,this.spans=null}bidiSpansAt(e){return(!this.line||this.line.from>e||this.line.to<e)&&(this.line=this.view.state.doc.lineAt(e),this.spans=this.view.bidiSpans(this.line)),this}baseDirAt(e,t){let{line:i,spans:n}=this.bidiSpansAt(e);return n[Si.find(n,e-i.from,-1,t)].level==this.baseDir}dirAt(e,t){let{line:i,spans:n}=this.bidiSpansAt(e);return n[Si.find(n,e-i.from,-1,t)].dir}bidiIn(e,t){let{spans:i,line:n}=this.bidiSpansAt(e);return i.length>1||i.length&&(i[0].level!=this.baseDir||i[0].to+n.from<t)}scan(e,t,i=!1){let n=0,r=e.length-1,o=new Set,a=this.bidiIn(e[0],e[r]),l,c,h=-1,u=1e9,f;e:for(;n<r;){let m=r-n,g=n+r>>1;t:if(o.has(g)){for(let w=1;w<m;w++){let A=g+w;if(A>=r&&(A-=m),!o.has(A)){g=A;break t}}break e}o.add(g);let y=t(g),_=0;if(y)for(let w=0;w<y.length;w++){let A=y[w];if(!(A.width==0&&y.length>1))if(A.bottom<this.y)(!l||l.bottom<A.bottom)&&(l=A),_=1;else if(A.top>this.y)(!c||c.top>A.top)&&(c=A),_=-1;else{let T=A.left>this.x?this.x-A.left:A.right<this.x?this.x-A.right:0,C=Math.abs(T);C<u&&(h=g,u=C,f=A),T&&(_=T<0==(this.baseDir==Ie.LTR)?-1:1)}}_==-1&&(!a||this.baseDirAt(e[g],1))?r=g:_==1&&(!a||this.baseDirAt(e[g+1],-1))&&(n=g+1)}if(!f){if(!c&&!l)return{i:0,after:!1};let m=l&&(!c||this.y-l.bottom<c.top-this.y)?l:c;return this.y=(m.top+m.bottom)/2,this.scan(e,t,!0)}if(u&&!i){let{top:m,bottom:g}=f;if(l&&l.bottom>(m+m+g)/3)return this.y=l.bottom-1,this.scan(e,t,!0);if(c&&c.top<(m+g+g)/3)return this.y=c.top+1,this.scan(e,t,!0)}let d=(a?this.dirAt(e[h],1):this.baseDir)==Ie.LTR;return{i:h,after:this.x>(f.left+f.right)/2==d}}scanText(e,t){let i=[];for(let r=0;r<e.length;r=nt(e.text,r))i.push(t+r);i.push(t+e.length);let n=this.scan(i,r=>{let o=i[r]-t,a=i[r+1]-t;return Po(e.dom,o,a).getClientRects()});return n.after?new _i(i[n.i+1],-1):new _i(i[n.i],1)}scanTile(e,t){if(!e.length)return new _i(t,1);if(e.children.length==1){let a=e.children[0];if(a.isText())return this.scanText(a,t);if(a.isComposite())return this.scanTile(a,t)}let i=[t];for(let a=0,l=t;a<e.children.length;a++)i.push(l+=e.children[a].length);let n=this.scan(i,a=>{let l=e.children[a];return l.flags&48?null:(bt(l.dom)?l.dom:Po(l.dom,0,l.length)).getClientRects()}),r=e.children[n.i],o=i[n.i];return r.isText()?this.scanText(r,o):r.isComposite()?this.scanTile(r,o):n.after?new _i(i[n.i+1],-1):new _i(o,1)}},fr="￿",_u=class{constructor(e,t){this.points=e,this.view=t,this.text="",this.lineSeparator=t.state.facet(Ue.lineSeparator)}append(e){this.text+=e}lineBreak(){this.text+=fr}readRange(e,t){if(!e)return this;let i=e.parentNode;for(let n=e;;){this.findPointBefore(i,n);let r=this.text.length;this.readNode(n);let o=Ke.get(n),a=n.nextSibling;if(a==t){o?.breakAfter&&!a&&i!=this.view.contentDOM&&this.lineBreak();break}let l=Ke.get(a);(o&&l?o.breakAfter:(o?o.breakAfter:el(n))||el(a)&&(n.nodeName!="BR"||o?.isWidget())&&this.text.length>r)&&!mS(a,t)&&this.lineBreak(),n=a}return this.findPointBefore(i,t),this}readTextNode(e){let t=e.nodeValue;for(let i of this.points)i.node==e&&(i.pos=this.text.length+Math.min(i.offset,t.length));for(let i=0,n=this.lineSeparator?null:/\r\n?|\n/g;;){let r=-1,o=1,a;if(this.lineSeparator?(r=t.indexOf(this.lineSeparator,i),o=this.lineSeparator.length):(a=n.exec(t))&&(r=a.index,o=a[0].length),this.append(t.slice(i,r<0?t.length:r)),r<0)break;if(this.lineBreak(),o>1)for(let l of this.points)l.node==e&&l.pos>this.text.length&&(l.pos-=o-1);i=r+o}}readNode(e){let t=Ke.get(e),i=t&&t.overrideDOMText;if(i!=null){this.findPointInside(e,i.length);for(let n=i.iter();!n.next().done;)n.lineBreak?this.lineBreak():this.append(n.value)}else yr(e)?this.readTextNode(e):e.nodeName=="BR"?e.nextSibling&&this.lineBreak():bt(e)&&this.readRange(e.firstChild,null)}findPointBefore(e,t){for(let i of this.points)i.node==e&&e.childNodes[i.offset]==t&&(i.pos=this.text.length)}findPointInside(e,t){for(let i of this.points)(yr(e)?i.node==e:e.contains(i.node))&&(i.pos=this.text.length+(pS(e,i.node,i.offset)?t:0))}};function pS(s,e,t){for(;;){if(!e||t<bn(e))return!1;if(e==s)return!0;t=Fn(e)+1,e=e.parentNode}}function mS(s,e){let t;for(;!(s==e||!s);s=s.nextSibling){let i=Ke.get(s);if(!i?.isWidget())return!1;i&&(t||(t=[])).push(i)}if(t)for(let i of t){let n=i.overrideDOMText;if(n?.length)return!1}return!0}var rl=class{constructor(e,t){this.node=e,this.offset=t,this.pos=-1}},Su=class{constructor(e,t,i,n){this.typeOver=n,this.bounds=null,this.text="",this.domChanged=t>-1;let{impreciseHead:r,impreciseAnchor:o}=e.docView,a=e.state.selection;if(e.state.readOnly&&t>-1)this.newSel=null;else if(t>-1&&(this.bounds=Wg(e.docView.tile,t,i,0))){let l=r||o?[]:xS(e),c=new _u(l,e);c.readRange(this.bounds.startDOM,this.bounds.endDOM),this.text=c.text,this.newSel=vS(l,this.bounds.from)}else{let l=e.observer.selectionRange,c=r&&r.node==l.focusNode&&r.offset==l.focusOffset||!su(e.contentDOM,l.focusNode)?a.main.head:e.docView.posFromDOM(l.focusNode,l.focusOffset),h=o&&o.node==l.anchorNode&&o.offset==l.anchorOffset||!su(e.contentDOM,l.anchorNode)?a.main.anchor:e.docView.posFromDOM(l.anchorNode,l.anchorOffset),u=e.viewport;if((q.ios||q.chrome)&&c!=h&&Math.min(c,h)<=a.main.from&&Math.max(c,h)>=a.main.to&&(u.from>0||u.to<e.state.doc.length)){let f=Math.min(c,h),d=Math.max(c,h),m=u.from-f,g=u.to-d;(m==0||m==1||f==0)&&(g==0||g==-1||d==e.state.doc.length)&&(c=0,h=e.state.doc.length)}if(e.inputState.composing>-1&&a.ranges.length>1)this.newSel=a.replaceRange(I.range(h,c));else if(e.lineWrapping&&h==c&&!(a.main.empty&&a.main.head==c)&&e.inputState.lastTouchTime>Date.now()-100){let f=e.coordsAtPos(c,-1),d=0;f&&(d=e.inputState.lastTouchY<=f.bottom?-1:1),this.newSel=I.create([I.cursor(c,d)])}else this.newSel=I.single(h,c)}}};function Wg(s,e,t,i){if(s.isComposite()){let n=-1,r=-1,o=-1,a=-1;for(let l=0,c=i,h=i;l<s.children.length;l++){let u=s.children[l],f=c+u.length;if(c<e&&f>t)return Wg(u,e,t,c);if(f>=e&&n==-1&&(n=l,r=c),c>t&&u.dom.parentNode==s.dom){o=l,a=h;break}h=f,c=f+u.breakAfter}return{from:r,to:a<0?i+s.length:a,startDOM:(n?s.children[n-1].dom.nextSibling:null)||s.dom.firstChild,endDOM:o<s.children.length&&o>=0?s.children[o].dom:null}}else return s.isText()?{from:i,to:i+s.length,startDOM:s.dom,endDOM:s.dom.nextSibling}:null}function qg(s,e){let t,{newSel:i}=e,{state:n}=s,r=n.selection.main,o=s.inputState.lastKeyTime>Date.now()-100?s.inputState.lastKeyCode:-1;if(e.bounds){let{from:a,to:l}=e.bounds,c=r.from,h=null;(o===8||q.android&&e.text.length<l-a)&&(c=r.to,h="end");let u=n.doc.sliceString(a,l,fr),f,d;!r.empty&&r.from>=a&&r.to<=l&&(e.typeOver||u!=e.text)&&u.slice(0,r.from-a)==e.text.slice(0,r.from-a)&&u.slice(r.to-a)==e.text.slice(f=e.text.length-(u.length-(r.to-a)))?t={from:r.from,to:r.to,insert:be.of(e.text.slice(r.from-a,f).split(fr))}:(d=Xg(u,e.text,c-a,h))&&(q.chrome&&o==13&&d.toB==d.from+2&&e.text.slice(d.from,d.toB)==fr+fr&&d.toB--,t={from:a+d.from,to:a+d.toA,insert:be.of(e.text.slice(d.from,d.toB).split(fr))})}else i&&(!s.hasFocus&&n.facet(xn)||wu(i,r))&&(i=null);if(!t&&!i)return!1;if((q.mac||q.android)&&t&&t.from==t.to&&t.from==r.head-1&&/^\. ?$/.test(t.insert.toString())&&s.contentDOM.getAttribute("autocorrect")=="off"?(i&&t.insert.length==2&&(i=I.single(i.main.anchor-1,i.main.head-1)),t={from:t.from,to:t.to,insert:be.of([t.insert.toString().replace("."," ")])}):n.doc.lineAt(r.from).to<r.to&&s.docView.lineHasWidget(r.to)&&s.inputState.insertingTextAt>Date.now()-50?t={from:r.from,to:r.to,insert:n.toText(s.inputState.insertingText)}:q.chrome&&t&&t.from==t.to&&t.from==r.head&&t.insert.toString()==`
 `&&s.lineWrapping&&(i&&(i=I.single(i.main.anchor-1,i.main.head-1)),t={from:r.from,to:r.to,insert:be.of([" "])}),t)return tf(s,t,i,o);if(i&&!wu(i,r)){let a=!1,l="select";return s.inputState.lastSelectionTime>Date.now()-50&&(s.inputState.lastSelectionOrigin=="select"&&(a=!0),l=s.inputState.lastSelectionOrigin,l=="select.pointer"&&(i=Gg(n.facet(ko).map(c=>c(s)),i))),s.dispatch({selection:i,scrollIntoView:a,userEvent:l}),!0}else return!1}function tf(s,e,t,i=-1){if(q.ios&&s.inputState.flushIOSKey(e))return!0;let n=s.state.selection.main;if(q.android&&(e.to==n.to&&(e.from==n.from||e.from==n.from-1&&s.state.sliceDoc(e.from,n.from)==" ")&&e.insert.length==1&&e.insert.lines==2&&vr(s.contentDOM,"Enter",13)||(e.from==n.from-1&&e.to==n.to&&e.insert.length==0||i==8&&e.insert.length<e.to-e.from&&e.to>n.head)&&vr(s.contentDOM,"Backspace",8)||e.from==n.from&&e.to==n.to+1&&e.insert.length==0&&vr(s.contentDOM,"Delete",46)))return!0;let r=e.insert.toString();s.inputState.composing>=0&&s.inputState.composing++;let o,a=()=>o||(o=gS(s,e,t));return s.state.facet(Pg).some(l=>l(s,e.from,e.to,r,a))||s.dispatch(a()),!0}function gS(s,e,t){let i,n=s.state,r=n.selection.main,o=-1;if(e.from==e.to&&e.from<r.from||e.from>r.to){let l=e.from<r.from?-1:1,c=l<0?r.from:r.to,h=wo(n.facet(ko).map(u=>u(s)),c,l);e.from==h&&(o=h)}if(o>-1)i={changes:e,selection:I.cursor(e.from+e.insert.length,-1)};else if(e.from>=r.from&&e.to<=r.to&&e.to-e.from>=(r.to-r.from)/3&&(!t||t.main.empty&&t.main.from==e.from+e.insert.length)&&s.inputState.composing<0){let l=r.from<e.from?n.sliceDoc(r.from,e.from):"",c=r.to>e.to?n.sliceDoc(e.to,r.to):"";i=n.replaceSelection(s.state.toText(l+e.insert.sliceString(0,void 0,s.state.lineBreak)+c))}else{let l=n.changes(e),c=t&&t.main.to<=l.newLength?t.main:void 0;if(n.selection.ranges.length>1&&(s.inputState.composing>=0||s.inputState.compositionPendingChange)&&e.to<=r.to+10&&e.to>=r.to-10){let h=s.state.sliceDoc(e.from,e.to),u,f=t&&Hg(s,t.main.head);if(f){let m=e.insert.length-(e.to-e.from);u={from:f.from,to:f.to-m}}else u=s.state.doc.lineAt(r.head);let d=r.to-e.to;i=n.changeByRange(m=>{if(m.from==r.from&&m.to==r.to)return{changes:l,range:c||m.map(l)};let g=m.to-d,y=g-h.length;if(s.state.sliceDoc(y,g)!=h||g>=u.from&&y<=u.to)return{range:m};let _=n.changes({from:y,to:g,insert:e.insert}),w=m.to-r.to;return{changes:_,range:c?I.range(Math.max(0,c.anchor+w),Math.max(0,c.head+w)):m.map(_)}})}else i={changes:l,selection:c&&n.selection.replaceRange(c)}}let a="input.type";return(s.composing||s.inputState.compositionPendingChange&&s.inputState.compositionEndedAt>Date.now()-50)&&(s.inputState.compositionPendingChange=!1,a+=".compose",s.inputState.compositionFirstChange&&(a+=".start",s.inputState.compositionFirstChange=!1)),n.update(i,{userEvent:a,scrollIntoView:!0})}function Xg(s,e,t,i){let n=Math.min(s.length,e.length),r=0;for(;r<n&&s.charCodeAt(r)==e.charCodeAt(r);)r++;if(r==n&&s.length==e.length)return null;let o=s.length,a=e.length;for(;o>0&&a>0&&s.charCodeAt(o-1)==e.charCodeAt(a-1);)o--,a--;if(i=="end"){let l=Math.max(0,r-Math.min(o,a));t-=o+l-r}if(o<r&&s.length<e.length){let l=t<=r&&t>=o?r-t:0;r-=l,a=r+(a-o),o=r}else if(a<r){let l=t<=r&&t>=a?r-t:0;r-=l,o=r+(o-a),a=r}return{from:r,toA:o,toB:a}}function xS(s){let e=[];if(s.root.activeElement!=s.contentDOM)return e;let{anchorNode:t,anchorOffset:i,focusNode:n,focusOffset:r}=s.observer.selectionRange;return t&&(e.push(new rl(t,i)),(n!=t||r!=i)&&e.push(new rl(n,r))),e}function vS(s,e){if(s.length==0)return null;let t=s[0].pos,i=s.length==2?s[1].pos:t;return t<0||i<0?null:t==i?I.create([I.cursor(i+e,-1)]):I.single(t+e,i+e)}function wu(s,e){return e.head==s.main.head&&e.anchor==s.main.anchor}var Mu=class{setSelectionOrigin(e){this.lastSelectionOrigin=e,this.lastSelectionTime=Date.now()}constructor(e){this.view=e,this.lastKeyCode=0,this.lastKeyTime=0,this.touchActive=!1,this.lastTouchTime=0,this.lastTouchX=0,this.lastTouchY=0,this.lastFocusTime=0,this.lastScrollTop=0,this.lastScrollLeft=0,this.lastWheelEvent=0,this.pendingIOSKey=void 0,this.lastIOSMomentumScroll=0,this.tabFocusMode=-1,this.lastSelectionOrigin=null,this.lastSelectionTime=0,this.lastContextMenu=0,this.scrollHandlers=[],this.handlers=Object.create(null),this.composing=-1,this.compositionFirstChange=null,this.compositionEndedAt=0,this.compositionPendingKey=!1,this.compositionPendingChange=!1,this.insertingText="",this.insertingTextAt=0,this.mouseSelection=null,this.draggedContent=null,this.handleEvent=this.handleEvent.bind(this),this.notifiedFocused=e.hasFocus,q.safari&&e.contentDOM.addEventListener("input",()=>null),q.gecko&&IS(e.contentDOM.ownerDocument)}handleEvent(e){!TS(this.view,e)||this.ignoreDuringComposition(e)||e.type=="keydown"&&this.keydown(e)||(this.view.updateState!=0?Promise.resolve().then(()=>this.runHandlers(e.type,e)):this.runHandlers(e.type,e))}runHandlers(e,t){let i=this.handlers[e];if(i){for(let n of i.observers)n(this.view,t);for(let n of i.handlers){if(t.defaultPrevented)break;if(n(this.view,t)){t.preventDefault();break}}}}ensureHandlers(e){let t=bS(e),i=this.handlers,n=this.view.contentDOM;for(let r in t)if(r!="scroll"){let o=!t[r].handlers.length,a=i[r];a&&o!=!a.handlers.length&&(n.removeEventListener(r,this.handleEvent),a=null),a||n.addEventListener(r,this.handleEvent,{passive:o})}for(let r in i)r!="scroll"&&!t[r]&&n.removeEventListener(r,this.handleEvent);this.handlers=t}keydown(e){if(this.lastKeyCode=e.keyCode,this.lastKeyTime=Date.now(),e.keyCode==9&&this.tabFocusMode>-1&&(!this.tabFocusMode||Date.now()<=this.tabFocusMode))return!0;if(this.tabFocusMode>0&&e.keyCode!=27&&Yg.indexOf(e.keyCode)<0&&(this.tabFocusMode=-1),q.android&&q.chrome&&!e.synthetic&&(e.keyCode==13||e.keyCode==8))return this.view.observer.delayAndroidKey(e.key,e.keyCode),!0;if(q.ios&&!e.synthetic&&!e.altKey&&!e.metaKey&&($g.some(t=>t.keyCode==e.keyCode)&&!e.ctrlKey||_S.indexOf(e.key)>-1&&e.ctrlKey)){let t={ctrlKey:e.ctrlKey,altKey:e.altKey,metaKey:e.metaKey,shiftKey:e.shiftKey};t.shiftKey&&q.ios&&!/^(off|none)$/.test(this.view.contentDOM.autocapitalize)&&yS(this.view.win)&&(t.shiftKey=!1);let i=this.pendingIOSKey={key:e.key,keyCode:e.keyCode,mods:t};return setTimeout(()=>{this.pendingIOSKey==i&&this.flushIOSKey()},50),!0}return e.keyCode!=229&&this.view.observer.forceFlush(),!1}flushIOSKey(e){let t=this.pendingIOSKey;return!t||this.view.observer.pendingRecords().length||t.key=="Enter"&&e&&e.from<e.to&&/^\S+$/.test(e.insert.toString())?!1:(this.pendingIOSKey=void 0,vr(this.view.contentDOM,t.key,t.keyCode,t.mods))}ignoreDuringComposition(e){return!/^key/.test(e.type)||e.synthetic?!1:this.composing>0?!0:q.safari&&!q.ios&&this.compositionPendingKey&&Date.now()-this.compositionEndedAt<100?(this.compositionPendingKey=!1,!0):!1}startMouseSelection(e){this.mouseSelection&&this.mouseSelection.destroy(),this.mouseSelection=e}update(e){this.view.observer.update(e),this.mouseSelection&&this.mouseSelection.update(e),this.draggedContent&&e.docChanged&&(this.draggedContent=this.draggedContent.map(e.changes)),e.transactions.length&&(this.lastKeyCode=this.lastSelectionTime=0)}destroy(){this.mouseSelection&&this.mouseSelection.destroy()}};function yS(s){return s.visualViewport?s.visualViewport.height*s.visualViewport.scale/s.document.documentElement.clientHeight<.85:!1}function Vm(s,e){return(t,i)=>{try{return e.call(s,i,t)}catch(n){ii(t.state,n)}}}function bS(s){let e=Object.create(null);function t(i){return e[i]||(e[i]={observers:[],handlers:[]})}for(let i of s){let n=i.spec,r=n&&n.plugin.domEventHandlers,o=n&&n.plugin.domEventObservers;if(r)for(let a in r){let l=r[a];l&&t(a).handlers.push(Vm(i.value,l))}if(o)for(let a in o){let l=o[a];l&&t(a).observers.push(Vm(i.value,l))}}for(let i in Fi)t(i).handlers.push(Fi[i]);for(let i in Vt)t(i).observers.push(Vt[i]);return e}var $g=[{key:"Backspace",keyCode:8,inputType:"deleteContentBackward"},{key:"Enter",keyCode:13,inputType:"insertParagraph"},{key:"Enter",keyCode:13,inputType:"insertLineBreak"},{key:"Delete",keyCode:46,inputType:"deleteContentForward"}],_S="dthko",Yg=[16,17,18,20,91,92,224,225],za=6;function Va(s){return Math.max(0,s)*.7+8}function SS(s,e){return Math.max(Math.abs(s.clientX-e.clientX),Math.abs(s.clientY-e.clientY))}var Au=class{constructor(e,t,i,n){this.view=e,this.startEvent=t,this.style=i,this.mustSelect=n,this.scrollSpeed={x:0,y:0},this.scrolling=-1,this.lastEvent=t,this.scrollParents=pg(e.contentDOM),this.atoms=e.state.facet(ko).map(o=>o(e));let r=e.contentDOM.ownerDocument;r.addEventListener("mousemove",this.move=this.move.bind(this)),r.addEventListener("mouseup",this.up=this.up.bind(this)),this.extend=t.shiftKey,this.multiple=e.state.facet(Ue.allowMultipleSelections)&&wS(e,t),this.dragging=AS(e,t)&&Zg(t)==1?null:!1}start(e){this.dragging===!1&&this.select(e)}move(e){if(e.buttons==0)return this.destroy();if(this.dragging||this.dragging==null&&SS(this.startEvent,e)<10)return;this.select(this.lastEvent=e);let t=0,i=0,n=0,r=0,o=this.view.win.innerWidth,a=this.view.win.innerHeight;this.scrollParents.x&&({left:n,right:o}=this.scrollParents.x.getBoundingClientRect()),this.scrollParents.y&&({top:r,bottom:a}=this.scrollParents.y.getBoundingClientRect());let l=ef(this.view);e.clientX-l.left<=n+za?t=-Va(n-e.clientX):e.clientX+l.right>=o-za&&(t=Va(e.clientX-o)),e.clientY-l.top<=r+za?i=-Va(r-e.clientY):e.clientY+l.bottom>=a-za&&(i=Va(e.clientY-a)),this.setScrollSpeed(t,i)}up(e){this.dragging==null&&this.select(this.lastEvent),this.dragging||e.preventDefault(),this.destroy()}destroy(){this.setScrollSpeed(0,0);let e=this.view.contentDOM.ownerDocument;e.removeEventListener("mousemove",this.move),e.removeEventListener("mouseup",this.up),this.view.inputState.mouseSelection=this.view.inputState.draggedContent=null}setScrollSpeed(e,t){this.scrollSpeed={x:e,y:t},e||t?this.scrolling<0&&(this.scrolling=setInterval(()=>this.scroll(),50)):this.scrolling>-1&&(clearInterval(this.scrolling),this.scrolling=-1)}scroll(){let{x:e,y:t}=this.scrollSpeed;e&&this.scrollParents.x&&(this.scrollParents.x.scrollLeft+=e,e=0),t&&this.scrollParents.y&&(this.scrollParents.y.scrollTop+=t,t=0),(e||t)&&this.view.win.scrollBy(e,t),this.dragging===!1&&this.select(this.lastEvent)}select(e){let{view:t}=this,i=Gg(this.atoms,this.style.get(e,this.extend,this.multiple));(this.mustSelect||!i.eq(t.state.selection,this.dragging===!1))&&this.view.dispatch({selection:i,userEvent:"select.pointer"}),this.mustSelect=!1}update(e){e.transactions.some(t=>t.isUserEvent("input.type"))?this.destroy():this.style.update(e)&&setTimeout(()=>this.select(this.lastEvent),20)}};function wS(s,e){let t=s.state.facet(Tg);return t.length?t[0](e):q.mac?e.metaKey:e.ctrlKey}function MS(s,e){let t=s.state.facet(Eg);return t.length?t[0](e):q.mac?!e.altKey:!e.ctrlKey}function AS(s,e){let{main:t}=s.state.selection;if(t.empty)return!1;let i=Ro(s.root);if(!i||i.rangeCount==0)return!0;let n=i.getRangeAt(0).getClientRects();for(let r=0;r<n.length;r++){let o=n[r];if(o.left<=e.clientX&&o.right>=e.clientX&&o.top<=e.clientY&&o.bottom>=e.clientY)return!0}return!1}function TS(s,e){if(!e.bubbles)return!0;if(e.defaultPrevented)return!1;for(let t=e.target,i;t!=s.contentDOM;t=t.parentNode)if(!t||t.nodeType==11||(i=Ke.get(t))&&i.isWidget()&&!i.isHidden&&i.widget.ignoreEvent(e))return!1;return!0}var Fi=Object.create(null),Vt=Object.create(null),Kg=q.ie&&q.ie_version<15||q.ios&&q.webkit_version<604;function ES(s){let e=s.dom.parentNode;if(!e)return;let t=e.appendChild(document.createElement("textarea"));t.style.cssText="position: fixed; left: -10000px; top: 10px",t.focus(),setTimeout(()=>{s.focus(),t.remove(),Jg(s,t.value)},50)}function xl(s,e,t){for(let i of s.facet(e))t=i(t,s);return t}function Jg(s,e){e=xl(s.state,Ju,e);let{state:t}=s,i,n=1,r=t.toText(e),o=r.lines==t.selection.ranges.length;if(Tu!=null&&t.selection.ranges.every(l=>l.empty)&&Tu==r.toString()){let l=-1;i=t.changeByRange(c=>{let h=t.doc.lineAt(c.from);if(h.from==l)return{range:c};l=h.from;let u=t.toText((o?r.line(n++).text:e)+t.lineBreak);return{changes:{from:h.from,insert:u},range:I.cursor(c.from+u.length,-1)}})}else o?i=t.changeByRange(l=>{let c=r.line(n++);return{changes:{from:l.from,to:l.to,insert:c.text},range:I.cursor(l.from+c.length,-1)}}):i=t.replaceSelection(r);s.dispatch(i,{userEvent:"input.paste",scrollIntoView:!0})}Vt.scroll=s=>{let e=s.inputState;e.lastScrollTop=s.scrollDOM.scrollTop,e.lastScrollLeft=s.scrollDOM.scrollLeft,q.ios&&!e.touchActive&&(e.lastIOSMomentumScroll=Date.now())};Vt.wheel=Vt.mousewheel=s=>{s.inputState.lastWheelEvent=Date.now()};Fi.keydown=(s,e)=>(s.inputState.setSelectionOrigin("select"),e.keyCode==27&&s.inputState.tabFocusMode!=0&&(s.inputState.tabFocusMode=Date.now()+2e3),!1);Vt.touchstart=(s,e)=>{let t=s.inputState,i=e.targetTouches[0];t.touchActive=!0,t.lastTouchTime=Date.now(),i&&(t.lastTouchX=i.clientX,t.lastTouchY=i.clientY),t.setSelectionOrigin("select.pointer")};Vt.touchmove=s=>{s.inputState.setSelectionOrigin("select.pointer")};Vt.touchend=(s,e)=>{s.inputState.touchActive=!1};Fi.mousedown=(s,e)=>{if(s.observer.flush(),s.inputState.lastTouchTime>Date.now()-2e3)return!1;let t=null;for(let i of s.state.facet(Cg))if(t=i(s,e),t)break;if(!t&&e.button==0&&(t=RS(s,e)),t){let i=!s.hasFocus;s.inputState.startMouseSelection(new Au(s,e,t,i)),i&&s.observer.ignore(()=>{xg(s.contentDOM);let r=s.root.activeElement;r&&!r.contains(s.contentDOM)&&r.blur()});let n=s.inputState.mouseSelection;if(n)return n.start(e),n.dragging===!1}else s.inputState.setSelectionOrigin("select.pointer");return!1};function Hm(s,e,t,i){if(i==1)return I.cursor(e,t);if(i==2)return cS(s.state,e,t);{let n=s.docView.lineAt(e,t),r=s.state.doc.lineAt(n?n.posAtEnd:e),o=n?n.posAtStart:r.from,a=n?n.posAtEnd:r.to;return a<s.state.doc.length&&a==r.to&&a++,I.undirectionalRange(o,a)}}var CS=q.ie&&q.ie_version<=11,Gm=null,Wm=0,qm=0;function Zg(s){if(!CS)return s.detail;let e=Gm,t=qm;return Gm=s,qm=Date.now(),Wm=!e||t>Date.now()-400&&Math.abs(e.clientX-s.clientX)<2&&Math.abs(e.clientY-s.clientY)<2?(Wm+1)%3:1}function RS(s,e){let t=s.posAndSideAtCoords({x:e.clientX,y:e.clientY},!1),i=Zg(e),n=s.state.selection;return{update(r){r.docChanged&&(t.pos=r.changes.mapPos(t.pos),n=n.map(r.changes))},get(r,o,a){let l=s.posAndSideAtCoords({x:r.clientX,y:r.clientY},!1),c,h=Hm(s,l.pos,l.assoc,i);if(t.pos!=l.pos&&!o){let u=Hm(s,t.pos,t.assoc,i),f=Math.min(u.from,h.from),d=Math.max(u.to,h.to);h=f<h.from?I.range(f,d,h.assoc):I.range(d,f,h.assoc)}return o?n.replaceRange(n.main.extend(h.from,h.to,h.assoc)):a&&i==1&&n.ranges.length>1&&(c=PS(n,l.pos))?c:a?n.addRange(h):I.create([h])}}}function PS(s,e){for(let t=0;t<s.ranges.length;t++){let{from:i,to:n}=s.ranges[t];if(i<=e&&n>=e)return I.create(s.ranges.slice(0,t).concat(s.ranges.slice(t+1)),s.mainIndex==t?0:s.mainIndex-(s.mainIndex>t?1:0))}return null}Fi.dragstart=(s,e)=>{let{selection:{main:t}}=s.state;if(e.target.draggable){let n=s.docView.tile.nearest(e.target);if(n&&n.isWidget()){let r=n.posAtStart,o=r+n.length;(r>=t.to||o<=t.from)&&(t=I.undirectionalRange(r,o))}}let{inputState:i}=s;return i.mouseSelection&&(i.mouseSelection.dragging=!0),i.draggedContent=t,e.dataTransfer&&(e.dataTransfer.setData("Text",xl(s.state,Zu,s.state.sliceDoc(t.from,t.to))),e.dataTransfer.effectAllowed="copyMove"),!1};Fi.dragend=s=>(s.inputState.draggedContent=null,!1);function Xm(s,e,t,i){if(t=xl(s.state,Ju,t),!t)return;let n=s.posAtCoords({x:e.clientX,y:e.clientY},!1),{draggedContent:r}=s.inputState,o=i&&r&&MS(s,e)?{from:r.from,to:r.to}:null,a={from:n,insert:t},l=s.state.changes(o?[o,a]:a);s.focus(),s.dispatch({changes:l,selection:{anchor:l.mapPos(n,-1),head:l.mapPos(n,1)},userEvent:o?"move.drop":"input.drop"}),s.inputState.draggedContent=null}Fi.drop=(s,e)=>{if(!e.dataTransfer)return!1;if(s.state.readOnly)return!0;let t=e.dataTransfer.files;if(t&&t.length){let i=Array(t.length),n=0,r=()=>{++n==t.length&&Xm(s,e,i.filter(o=>o!=null).join(s.state.lineBreak),!1)};for(let o=0;o<t.length;o++){let a=new FileReader;a.onerror=r,a.onload=()=>{/[\x00-\x08\x0e-\x1f]{2}/.test(a.result)||(i[o]=a.result),r()},a.readAsText(t[o])}return!0}else{let i=e.dataTransfer.getData("Text");if(i)return Xm(s,e,i,!0),!0}return!1};Fi.paste=(s,e)=>{if(s.state.readOnly)return!0;s.observer.flush();let t=Kg?null:e.clipboardData;return t?(Jg(s,t.getData("text/plain")||t.getData("text/uri-list")),!0):(ES(s),!1)};function kS(s,e){let t=s.dom.parentNode;if(!t)return;let i=t.appendChild(document.createElement("textarea"));i.style.cssText="position: fixed; left: -10000px; top: 10px",i.value=e,i.focus(),i.selectionEnd=e.length,i.selectionStart=0,setTimeout(()=>{i.remove(),s.focus()},50)}function LS(s){let e=[],t=[],i=!1;for(let n of s.selection.ranges)n.empty||(e.push(s.sliceDoc(n.from,n.to)),t.push(n));if(!e.length){let n=-1;for(let{from:r}of s.selection.ranges){let o=s.doc.lineAt(r);o.number>n&&(e.push(o.text),t.push({from:o.from,to:Math.min(s.doc.length,o.to+1)})),n=o.number}i=!0}return{text:xl(s,Zu,e.join(s.lineBreak)),ranges:t,linewise:i}}var Tu=null;Fi.copy=Fi.cut=(s,e)=>{if(!vo(s.contentDOM,s.observer.selectionRange))return!1;let{text:t,ranges:i,linewise:n}=LS(s.state);if(!t&&!n)return!1;Tu=n?t:null,e.type=="cut"&&!s.state.readOnly&&s.dispatch({changes:i,scrollIntoView:!0,userEvent:"delete.cut"});let r=Kg?null:e.clipboardData;return r?(r.clearData(),r.setData("text/plain",t),!0):(kS(s,t),!1)};var jg=Di.define();function Qg(s,e){let t=[];for(let i of s.facet(kg)){let n=i(s,e);n&&t.push(n)}return t.length?s.update({effects:t,annotations:jg.of(!0)}):null}function e0(s){setTimeout(()=>{let e=s.hasFocus;if(e!=s.inputState.notifiedFocused){let t=Qg(s.state,e);t?s.dispatch(t):s.update([])}},10)}Vt.focus=s=>{s.inputState.lastFocusTime=Date.now(),!s.scrollDOM.scrollTop&&(s.inputState.lastScrollTop||s.inputState.lastScrollLeft)&&(s.scrollDOM.scrollTop=s.inputState.lastScrollTop,s.scrollDOM.scrollLeft=s.inputState.lastScrollLeft),e0(s)};Vt.blur=s=>{s.observer.clearSelectionRange(),e0(s)};Vt.compositionstart=Vt.compositionupdate=(s,e)=>{if(!s.observer.editContext&&(s.inputState.compositionFirstChange==null&&(s.inputState.compositionFirstChange=!0),s.inputState.composing<0)){let{main:t}=s.state.selection;!t.empty&&s.lineBlockAt(t.from).from!=s.lineBlockAt(t.to).from&&!s.state.readOnly&&s.dispatch({changes:s.state.selection.ranges.filter(i=>!i.empty).map(i=>({from:i.from,to:i.to})),userEvent:"input"}),s.inputState.composing=0}};Vt.compositionend=s=>{s.observer.editContext||(s.inputState.composing=-1,s.inputState.compositionEndedAt=Date.now(),s.inputState.compositionPendingKey=!0,s.inputState.compositionPendingChange=s.observer.pendingRecords().length>0,s.inputState.compositionFirstChange=null,q.chrome&&q.android?s.observer.flushSoon():s.inputState.compositionPendingChange?Promise.resolve().then(()=>s.observer.flush()):setTimeout(()=>{s.inputState.composing<0&&s.docView.hasComposition&&s.update([])},50))};Vt.contextmenu=s=>{s.inputState.lastContextMenu=Date.now()};Fi.beforeinput=(s,e)=>{var t,i;if((e.inputType=="insertText"||e.inputType=="insertCompositionText")&&(s.inputState.insertingText=e.data,s.inputState.insertingTextAt=Date.now()),e.inputType=="insertReplacementText"&&s.observer.editContext){let r=(t=e.dataTransfer)===null||t===void 0?void 0:t.getData("text/plain"),o=e.getTargetRanges();if(r&&o.length){let a=o[0],l=s.posAtDOM(a.startContainer,a.startOffset),c=s.posAtDOM(a.endContainer,a.endOffset);return tf(s,{from:l,to:c,insert:s.state.toText(r)},null),!0}}let n;if(q.chrome&&q.android&&(n=$g.find(r=>r.inputType==e.inputType))&&(s.observer.delayAndroidKey(n.key,n.keyCode),n.key=="Backspace"||n.key=="Delete")){let r=((i=window.visualViewport)===null||i===void 0?void 0:i.height)||0;setTimeout(()=>{var o;(((o=window.visualViewport)===null||o===void 0?void 0:o.height)||0)>r+10&&s.hasFocus&&(s.contentDOM.blur(),s.focus())},100)}return q.ios&&e.inputType=="deleteContentForward"&&s.observer.flushSoon(),q.safari&&e.inputType=="insertText"&&s.inputState.composing>=0&&setTimeout(()=>Vt.compositionend(s,e),20),!1};var $m=new Set;function IS(s){$m.has(s)||($m.add(s),s.addEventListener("copy",()=>{}),s.addEventListener("cut",()=>{}))}var Ym=["pre-wrap","normal","pre-line","break-spaces"],Ar=!1;function Km(){Ar=!1}var Eu=class{constructor(e){this.lineWrapping=e,this.doc=be.empty,this.heightSamples={},this.lineHeight=14,this.charWidth=7,this.textHeight=14,this.lineLength=30}heightForGap(e,t){let i=this.doc.lineAt(t).number-this.doc.lineAt(e).number+1;return this.lineWrapping&&(i+=Math.max(0,Math.ceil((t-e-i*this.lineLength*.5)/this.lineLength))),this.lineHeight*i}heightForLine(e){return this.lineWrapping?(1+Math.max(0,Math.ceil((e-this.lineLength)/Math.max(1,this.lineLength-5))))*this.lineHeight:this.lineHeight}setDoc(e){return this.doc=e,this}mustRefreshForWrapping(e){return Ym.indexOf(e)>-1!=this.lineWrapping}mustRefreshForHeights(e){let t=!1;for(let i=0;i<e.length;i++){let n=e[i];n<0?i++:this.heightSamples[Math.floor(n*10)]||(t=!0,this.heightSamples[Math.floor(n*10)]=!0)}return t}refresh(e,t,i,n,r,o){let a=Ym.indexOf(e)>-1,l=Math.abs(t-this.lineHeight)>.3||this.lineWrapping!=a;if(this.lineWrapping=a,this.lineHeight=t,this.charWidth=i,this.textHeight=n,this.lineLength=r,l){this.heightSamples={};for(let c=0;c<o.length;c++){let h=o[c];h<0?c++:this.heightSamples[Math.floor(h*10)]=!0}}return l}},Cu=class{constructor(e,t){this.from=e,this.heights=t,this.index=0}get more(){return this.index<this.heights.length}},Ni=class s{constructor(e,t,i,n,r){this.from=e,this.length=t,this.top=i,this.height=n,this._content=r}get type(){return typeof this._content=="number"?Tt.Text:Array.isArray(this._content)?this._content:this._content.type}get to(){return this.from+this.length}get bottom(){return this.top+this.height}get widget(){return this._content instanceof vs?this._content.widget:null}get widgetLineBreaks(){return typeof this._content=="number"?this._content:0}join(e){let t=(Array.isArray(this._content)?this._content:[this]).concat(Array.isArray(e._content)?e._content:[e]);return new s(this.from,this.length+e.length,this.top,this.height+e.height,t)}},ze=(function(s){return s[s.ByPos=0]="ByPos",s[s.ByHeight=1]="ByHeight",s[s.ByPosNoHeight=2]="ByPosNoHeight",s})(ze||(ze={})),Ka=.001,ni=class s{constructor(e,t,i=2){this.length=e,this.height=t,this.flags=i}get outdated(){return(this.flags&2)>0}set outdated(e){this.flags=(e?2:0)|this.flags&-3}setHeight(e){this.height!=e&&(Math.abs(this.height-e)>Ka&&(Ar=!0),this.height=e)}replace(e,t,i){return s.of(i)}decomposeLeft(e,t){t.push(this)}decomposeRight(e,t){t.push(this)}applyChanges(e,t,i,n){let r=this,o=i.doc;for(let a=n.length-1;a>=0;a--){let{fromA:l,toA:c,fromB:h,toB:u}=n[a],f=r.lineAt(l,ze.ByPosNoHeight,i.setDoc(t),0,0),d=f.to>=c?f:r.lineAt(c,ze.ByPosNoHeight,i,0,0);for(u+=d.to-c,c=d.to;a>0&&f.from<=n[a-1].toA;)l=n[a-1].fromA,h=n[a-1].fromB,a--,l<f.from&&(f=r.lineAt(l,ze.ByPosNoHeight,i,0,0));h+=f.from-l,l=f.from;let m=Pu.build(i.setDoc(o),e,h,u);r=ol(r,r.replace(l,c,m))}return r.updateHeight(i,0)}static empty(){return new bi(0,0,0)}static of(e){if(e.length==1)return e[0];let t=0,i=e.length,n=0,r=0;for(;;)if(t==i)if(n>r*2){let a=e[t-1];a.break?e.splice(--t,1,a.left,null,a.right):e.splice(--t,1,a.left,a.right),i+=1+a.break,n-=a.size}else if(r>n*2){let a=e[i];a.break?e.splice(i,1,a.left,null,a.right):e.splice(i,1,a.left,a.right),i+=2+a.break,r-=a.size}else break;else if(n<r){let a=e[t++];a&&(n+=a.size)}else{let a=e[--i];a&&(r+=a.size)}let o=!1;return e[t-1]==null?(o=!0,t--):e[t]==null&&(o=!0,i++),new Ru(s.of(e.slice(0,t)),o,s.of(e.slice(i)))}};function ol(s,e){return s==e?s:(s.constructor!=e.constructor&&(Ar=!0),e)}ni.prototype.size=1;var DS=oe.replace({}),al=class extends ni{constructor(e,t,i){super(e,t),this.deco=i,this.spaceAbove=0}mainBlock(e,t){return new Ni(t,this.length,e+this.spaceAbove,this.height-this.spaceAbove,this.deco||0)}blockAt(e,t,i,n){return this.spaceAbove&&e<i+this.spaceAbove?new Ni(n,0,i,this.spaceAbove,DS):this.mainBlock(i,n)}lineAt(e,t,i,n,r){let o=this.mainBlock(n,r);return this.spaceAbove?this.blockAt(0,i,n,r).join(o):o}forEachLine(e,t,i,n,r,o){e<=r+this.length&&t>=r&&o(this.lineAt(0,ze.ByPos,i,n,r))}setMeasuredHeight(e){let t=e.heights[e.index++];t<0?(this.spaceAbove=-t,t=e.heights[e.index++]):this.spaceAbove=0,this.setHeight(t)}updateHeight(e,t=0,i=!1,n){return n&&n.from<=t&&n.more&&this.setMeasuredHeight(n),this.outdated=!1,this}toString(){return`block(${this.length})`}},bi=class s extends al{constructor(e,t,i){super(e,t,null),this.collapsed=0,this.widgetHeight=0,this.breaks=0,this.spaceAbove=i}mainBlock(e,t){return new Ni(t,this.length,e+this.spaceAbove,this.height-this.spaceAbove,this.breaks)}replace(e,t,i){let n=i[0];return i.length==1&&(n instanceof s||n instanceof On&&n.flags&4)&&Math.abs(this.length-n.length)<10?(n instanceof On?n=new s(n.length,this.height,this.spaceAbove):n.height=this.height,this.outdated||(n.outdated=!1),n):ni.of(i)}updateHeight(e,t=0,i=!1,n){return n&&n.from<=t&&n.more?this.setMeasuredHeight(n):(i||this.outdated)&&(this.spaceAbove=0,this.setHeight(Math.max(this.widgetHeight,e.heightForLine(this.length-this.collapsed))+this.breaks*e.lineHeight)),this.outdated=!1,this}toString(){return`line(${this.length}${this.collapsed?-this.collapsed:""}${this.widgetHeight?":"+this.widgetHeight:""})`}},On=class s extends ni{constructor(e){super(e,0)}heightMetrics(e,t){let i=e.doc.lineAt(t).number,n=e.doc.lineAt(t+this.length).number,r=n-i+1,o,a=0;if(e.lineWrapping){let l=Math.min(this.height,e.lineHeight*r);o=l/r,this.length>r+1&&(a=(this.height-l)/(this.length-r-1))}else o=this.height/r;return{firstLine:i,lastLine:n,perLine:o,perChar:a}}blockAt(e,t,i,n){let{firstLine:r,lastLine:o,perLine:a,perChar:l}=this.heightMetrics(t,n);if(t.lineWrapping){let c=n+(e<t.lineHeight?0:Math.round(Math.max(0,Math.min(1,(e-i)/this.height))*this.length)),h=t.doc.lineAt(c),u=a+h.length*l,f=Math.max(i,e-u/2);return new Ni(h.from,h.length,f,u,0)}else{let c=Math.max(0,Math.min(o-r,Math.floor((e-i)/a))),{from:h,length:u}=t.doc.line(r+c);return new Ni(h,u,i+a*c,a,0)}}lineAt(e,t,i,n,r){if(t==ze.ByHeight)return this.blockAt(e,i,n,r);if(t==ze.ByPosNoHeight){let{from:d,to:m}=i.doc.lineAt(e);return new Ni(d,m-d,0,0,0)}let{firstLine:o,perLine:a,perChar:l}=this.heightMetrics(i,r),c=i.doc.lineAt(e),h=a+c.length*l,u=c.number-o,f=n+a*u+l*(c.from-r-u);return new Ni(c.from,c.length,Math.max(n,Math.min(f,n+this.height-h)),h,0)}forEachLine(e,t,i,n,r,o){e=Math.max(e,r),t=Math.min(t,r+this.length);let{firstLine:a,perLine:l,perChar:c}=this.heightMetrics(i,r);for(let h=e,u=n;h<=t;){let f=i.doc.lineAt(h);if(h==e){let m=f.number-a;u+=l*m+c*(e-r-m)}let d=l+c*f.length;o(new Ni(f.from,f.length,u,d,0)),u+=d,h=f.to+1}}replace(e,t,i){let n=this.length-t;if(n>0){let r=i[i.length-1];r instanceof s?i[i.length-1]=new s(r.length+n):i.push(null,new s(n-1))}if(e>0){let r=i[0];r instanceof s?i[0]=new s(e+r.length):i.unshift(new s(e-1),null)}return ni.of(i)}decomposeLeft(e,t){t.push(new s(e-1),null)}decomposeRight(e,t){t.push(null,new s(this.length-e-1))}updateHeight(e,t=0,i=!1,n){let r=t+this.length;if(n&&n.from<=t+this.length&&n.more){let o=[],a=Math.max(t,n.from),l=-1;for(n.from>t&&o.push(new s(n.from-t-1).updateHeight(e,t));a<=r&&n.more;){let h=e.doc.lineAt(a).length;o.length&&o.push(null);let u=n.heights[n.index++],f=0;u<0&&(f=-u,u=n.heights[n.index++]),l==-1?l=u:Math.abs(u-l)>=Ka&&(l=-2);let d=new bi(h,u,f);d.outdated=!1,o.push(d),a+=h+1}a<=r&&o.push(null,new s(r-a).updateHeight(e,a));let c=ni.of(o);return(l<0||Math.abs(c.height-this.height)>=Ka||Math.abs(l-this.heightMetrics(e,t).perLine)>=Ka)&&(Ar=!0),ol(this,c)}else(i||this.outdated)&&(this.setHeight(e.heightForGap(t,t+this.length)),this.outdated=!1);return this}toString(){return`gap(${this.length})`}},Ru=class extends ni{constructor(e,t,i){super(e.length+(t?1:0)+i.length,e.height+i.height,(t?1:0)|(e.outdated||i.outdated?2:0)),this.left=e,this.right=i,this.size=e.size+i.size}get break(){return this.flags&1}blockAt(e,t,i,n){let r=i+this.left.height;return e<r?this.left.blockAt(e,t,i,n):this.right.blockAt(e,t,r,n+this.left.length+this.break)}lineAt(e,t,i,n,r){let o=n+this.left.height,a=r+this.left.length+this.break,l=t==ze.ByHeight?e<o:e<a,c=l?this.left.lineAt(e,t,i,n,r):this.right.lineAt(e,t,i,o,a);if(this.break||(l?c.to<a:c.from>a))return c;let h=t==ze.ByPosNoHeight?ze.ByPosNoHeight:ze.ByPos;return l?c.join(this.right.lineAt(a,h,i,o,a)):this.left.lineAt(a,h,i,n,r).join(c)}forEachLine(e,t,i,n,r,o){let a=n+this.left.height,l=r+this.left.length+this.break;if(this.break)e<l&&this.left.forEachLine(e,t,i,n,r,o),t>=l&&this.right.forEachLine(e,t,i,a,l,o);else{let c=this.lineAt(l,ze.ByPos,i,n,r);e<c.from&&this.left.forEachLine(e,Math.min(t,c.from-1),i,n,r,o),c.to>=e&&c.from<=t&&o(c),t>c.to&&this.right.forEachLine(Math.max(e,c.to+1),t,i,a,l,o)}}replace(e,t,i){let n=this.left.length+this.break;if(t<n)return this.balanced(this.left.replace(e,t,i),this.right);if(e>this.left.length)return this.balanced(this.left,this.right.replace(e-n,t-n,i));let r=[];e>0&&this.decomposeLeft(e,r);let o=r.length;for(let a of i)r.push(a);if(e>0&&Jm(r,o-1),t<this.length){let a=r.length;this.decomposeRight(t,r),Jm(r,a)}return ni.of(r)}decomposeLeft(e,t){let i=this.left.length;if(e<=i)return this.left.decomposeLeft(e,t);t.push(this.left),this.break&&(i++,e>=i&&t.push(null)),e>i&&this.right.decomposeLeft(e-i,t)}decomposeRight(e,t){let i=this.left.length,n=i+this.break;if(e>=n)return this.right.decomposeRight(e-n,t);e<i&&this.left.decomposeRight(e,t),this.break&&e<n&&t.push(null),t.push(this.right)}balanced(e,t){return e.size>2*t.size||t.size>2*e.size?ni.of(this.break?[e,null,t]:[e,t]):(this.left=ol(this.left,e),this.right=ol(this.right,t),this.setHeight(e.height+t.height),this.outdated=e.outdated||t.outdated,this.size=e.size+t.size,this.length=e.length+this.break+t.length,this)}updateHeight(e,t=0,i=!1,n){let{left:r,right:o}=this,a=t+r.length+this.break,l=null;return n&&n.from<=t+r.length&&n.more?l=r=r.updateHeight(e,t,i,n):r.updateHeight(e,t,i),n&&n.from<=a+o.length&&n.more?l=o=o.updateHeight(e,a,i,n):o.updateHeight(e,a,i),l?this.balanced(r,o):(this.height=this.left.height+this.right.height,this.outdated=!1,this)}toString(){return this.left+(this.break?" ":"-")+this.right}};function Jm(s,e){let t,i;s[e]==null&&(t=s[e-1])instanceof On&&(i=s[e+1])instanceof On&&s.splice(e-1,3,new On(t.length+1+i.length))}var NS=5,Pu=class s{constructor(e,t){this.pos=e,this.oracle=t,this.nodes=[],this.lineStart=-1,this.lineEnd=-1,this.covering=null,this.writtenTo=e}get isCovered(){return this.covering&&this.nodes[this.nodes.length-1]==this.covering}span(e,t){if(this.lineStart>-1){let i=Math.min(t,this.lineEnd),n=this.nodes[this.nodes.length-1];n instanceof bi?n.length+=i-this.pos:(i>this.pos||!this.isCovered)&&this.nodes.push(new bi(i-this.pos,-1,0)),this.writtenTo=i,t>i&&(this.nodes.push(null),this.writtenTo++,this.lineStart=-1)}this.pos=t}point(e,t,i){if(e<t||i.heightRelevant){let n=i.widget?i.widget.estimatedHeight:0,r=i.widget?i.widget.lineBreaks:0;n<0&&(n=this.oracle.lineHeight);let o=t-e;i.block?this.addBlock(new al(o,n,i)):(o||r||n>=NS)&&this.addLineDeco(n,r,o)}else t>e&&this.span(e,t);this.lineEnd>-1&&this.lineEnd<this.pos&&(this.lineEnd=this.oracle.doc.lineAt(this.pos).to)}enterLine(){if(this.lineStart>-1)return;let{from:e,to:t}=this.oracle.doc.lineAt(this.pos);this.lineStart=e,this.lineEnd=t,this.writtenTo<e&&((this.writtenTo<e-1||this.nodes[this.nodes.length-1]==null)&&this.nodes.push(this.blankContent(this.writtenTo,e-1)),this.nodes.push(null)),this.pos>e&&this.nodes.push(new bi(this.pos-e,-1,0)),this.writtenTo=this.pos}blankContent(e,t){let i=new On(t-e);return this.oracle.doc.lineAt(e).to==t&&(i.flags|=4),i}ensureLine(){this.enterLine();let e=this.nodes.length?this.nodes[this.nodes.length-1]:null;if(e instanceof bi)return e;let t=new bi(0,-1,0);return this.nodes.push(t),t}addBlock(e){this.enterLine();let t=e.deco;t&&t.startSide>0&&!this.isCovered&&this.ensureLine(),this.nodes.push(e),this.writtenTo=this.pos=this.pos+e.length,t&&t.endSide>0&&(this.covering=e)}addLineDeco(e,t,i){let n=this.ensureLine();n.length+=i,n.collapsed+=i,n.widgetHeight=Math.max(n.widgetHeight,e),n.breaks+=t,this.writtenTo=this.pos=this.pos+i}finish(e){let t=this.nodes.length==0?null:this.nodes[this.nodes.length-1];this.lineStart>-1&&!(t instanceof bi)&&!this.isCovered?this.nodes.push(new bi(0,-1,0)):(this.writtenTo<this.pos||t==null)&&this.nodes.push(this.blankContent(this.writtenTo,this.pos));let i=e;for(let n of this.nodes)n instanceof bi&&n.updateHeight(this.oracle,i),i+=n?n.length:1;return this.nodes}static build(e,t,i,n){let r=new s(i,e);return Me.spans(t,i,n,r,0),r.finish(i)}};function OS(s,e,t){let i=new ku;return Me.compare(s,e,t,i,0),i.changes}var ku=class{constructor(){this.changes=[]}compareRange(){}comparePoint(e,t,i,n){(e<t||i&&i.heightRelevant||n&&n.heightRelevant)&&xr(e,t,this.changes,5)}};function FS(s,e){let t=s.getBoundingClientRect(),i=s.ownerDocument,n=i.defaultView||window,r=Math.max(0,t.left),o=Math.min(n.innerWidth,t.right),a=Math.max(0,t.top),l=Math.min(n.innerHeight,t.bottom);for(let c=s.parentNode;c&&c!=i.body;)if(bt(c)){let h=window.getComputedStyle(c);if((c.scrollHeight>c.clientHeight||c.scrollWidth>c.clientWidth)&&h.overflow!="visible"){let u=c.getBoundingClientRect();r=Math.max(r,u.left),o=Math.min(o,u.right),a=Math.max(a,u.top),l=Math.min(c==s.parentNode?n.innerHeight:l,u.bottom)}c=h.position=="absolute"||h.position=="fixed"?c.offsetParent:c.parentNode}else if(c.nodeType==11)c=c.host;else break;return{left:r-t.left,right:Math.max(r,o)-t.left,top:a-(t.top+e),bottom:Math.max(a,l)-(t.top+e)}}function BS(s){let e=s.getBoundingClientRect(),t=s.ownerDocument.defaultView||window;return e.left<t.innerWidth&&e.right>0&&e.top<t.innerHeight&&e.bottom>0}function US(s,e){let t=s.getBoundingClientRect();return{left:0,right:t.right-t.left,top:e,bottom:t.bottom-(t.top+e)}}var Mo=class{constructor(e,t,i,n){this.from=e,this.to=t,this.size=i,this.displaySize=n}static same(e,t){if(e.length!=t.length)return!1;for(let i=0;i<e.length;i++){let n=e[i],r=t[i];if(n.from!=r.from||n.to!=r.to||n.size!=r.size)return!1}return!0}draw(e,t){return oe.replace({widget:new Lu(this.displaySize*(t?e.scaleY:e.scaleX),t)}).range(this.from,this.to)}},Lu=class extends yn{constructor(e,t){super(),this.size=e,this.vertical=t}eq(e){return e.size==this.size&&e.vertical==this.vertical}toDOM(){let e=document.createElement("div");return this.vertical?e.style.height=this.size+"px":(e.style.width=this.size+"px",e.style.height="2px",e.style.display="inline-block"),e}get estimatedHeight(){return this.vertical?this.size:-1}},ll=class{constructor(e,t){this.view=e,this.state=t,this.pixelViewport={left:0,right:window.innerWidth,top:0,bottom:0},this.inView=!0,this.paddingTop=0,this.paddingBottom=0,this.contentDOMWidth=0,this.contentDOMHeight=0,this.editorHeight=0,this.editorWidth=0,this.scaleX=1,this.scaleY=1,this.scrollOffset=0,this.scrolledToBottom=!1,this.scrollAnchorPos=0,this.scrollAnchorHeight=-1,this.scaler=Iu,this.scrollTarget=null,this.printing=!1,this.mustMeasureContent=!0,this.defaultTextDirection=Ie.LTR,this.visibleRanges=[],this.mustEnforceCursorAssoc=!1;let i=t.facet(ju).some(n=>typeof n!="function"&&n.class=="cm-lineWrapping");this.heightOracle=new Eu(i),this.stateDeco=Zm(t),this.heightMap=ni.empty().applyChanges(this.stateDeco,be.empty,this.heightOracle.setDoc(t.doc),[new Oi(0,0,0,t.doc.length)]);for(let n=0;n<2&&(this.viewport=this.getViewport(0,null),!!this.updateForViewport());n++);this.updateViewportLines(),this.lineGaps=this.ensureLineGaps([]),this.lineGapDeco=oe.set(this.lineGaps.map(n=>n.draw(this,!1))),this.scrollParent=e.scrollDOM,this.computeVisibleRanges()}updateForViewport(){let e=[this.viewport],{main:t}=this.state.selection;for(let i=0;i<=1;i++){let n=i?t.head:t.anchor;if(!e.some(({from:r,to:o})=>n>=r&&n<=o)){let{from:r,to:o}=this.lineBlockAt(n);e.push(new pr(r,o))}}return this.viewports=e.sort((i,n)=>i.from-n.from),this.updateScaler()}updateScaler(){let e=this.scaler;return this.scaler=this.heightMap.height<=7e6?Iu:Du.get(this.heightOracle,this.heightMap,this.viewports),e.eq(this.scaler)?0:2}updateViewportLines(){this.viewportLines=[],this.heightMap.forEachLine(this.viewport.from,this.viewport.to,this.heightOracle.setDoc(this.state.doc),0,0,e=>{this.viewportLines.push(xo(e,this.scaler))})}update(e,t=null){this.state=e.state;let i=this.stateDeco;this.stateDeco=Zm(this.state);let n=e.changedRanges,r=Oi.extendWithRanges(n,OS(i,this.stateDeco,e?e.changes:Ut.empty(this.state.doc.length))),o=this.heightMap.height,a=this.scrolledToBottom?null:this.scrollAnchorAt(this.scrollOffset);Km(),this.heightMap=this.heightMap.applyChanges(this.stateDeco,e.startState.doc,this.heightOracle.setDoc(this.state.doc),r),(this.heightMap.height!=o||Ar)&&(e.flags|=2),a?(this.scrollAnchorPos=e.changes.mapPos(a.from,-1),this.scrollAnchorHeight=a.top):(this.scrollAnchorPos=-1,this.scrollAnchorHeight=o);let l=r.length?this.mapViewport(this.viewport,e.changes):this.viewport;(t&&(t.range.head<l.from||t.range.head>l.to)||!this.viewportIsAppropriate(l))&&(l=this.getViewport(0,t));let c=l.from!=this.viewport.from||l.to!=this.viewport.to;this.viewport=l,e.flags|=this.updateForViewport(),(c||!e.changes.empty||e.flags&2)&&this.updateViewportLines(),(this.lineGaps.length||this.viewport.to-this.viewport.from>4e3)&&this.updateLineGaps(this.ensureLineGaps(this.mapLineGaps(this.lineGaps,e.changes))),e.flags|=this.computeVisibleRanges(e.changes),t&&(this.scrollTarget=t),!this.mustEnforceCursorAssoc&&(e.selectionSet||e.focusChanged)&&e.view.lineWrapping&&e.state.selection.main.empty&&e.state.selection.main.assoc&&!e.state.facet(Ig)&&(this.mustEnforceCursorAssoc=!0)}measure(){let{view:e}=this,t=e.contentDOM,i=window.getComputedStyle(t),n=this.heightOracle,r=i.whiteSpace;this.defaultTextDirection=i.direction=="rtl"?Ie.RTL:Ie.LTR;let o=this.heightOracle.mustRefreshForWrapping(r)||this.mustMeasureContent==="refresh",a=t.getBoundingClientRect(),l=o||this.mustMeasureContent||this.contentDOMHeight!=a.height;this.contentDOMHeight=a.height,this.mustMeasureContent=!1;let c=0,h=0;if(a.width&&a.height){let{scaleX:C,scaleY:E}=dg(t,a);(C>.005&&Math.abs(this.scaleX-C)>.005||E>.005&&Math.abs(this.scaleY-E)>.005)&&(this.scaleX=C,this.scaleY=E,c|=16,o=l=!0)}let u=(parseInt(i.paddingTop)||0)*this.scaleY,f=(parseInt(i.paddingBottom)||0)*this.scaleY;(this.paddingTop!=u||this.paddingBottom!=f)&&(this.paddingTop=u,this.paddingBottom=f,c|=18),this.editorWidth!=e.scrollDOM.clientWidth&&(n.lineWrapping&&(l=!0),this.editorWidth=e.scrollDOM.clientWidth,c|=16);let d=pg(this.view.contentDOM,!1).y;d!=this.scrollParent&&(this.scrollParent=d,this.scrollAnchorHeight=-1,this.scrollOffset=0);let m=this.getScrollOffset();this.scrollOffset!=m&&(this.scrollAnchorHeight=-1,this.scrollOffset=m),this.scrolledToBottom=vg(this.scrollParent||e.win);let g=(this.printing?US:FS)(t,this.paddingTop),y=g.top-this.pixelViewport.top,_=g.bottom-this.pixelViewport.bottom;this.pixelViewport=g;let w=this.pixelViewport.bottom>this.pixelViewport.top&&this.pixelViewport.right>this.pixelViewport.left;if(w!=this.inView&&(this.inView=w,w&&(l=!0)),!this.inView&&!this.scrollTarget&&!BS(e.dom))return 0;let A=a.width;if((this.contentDOMWidth!=A||this.editorHeight!=e.scrollDOM.clientHeight)&&(this.contentDOMWidth=a.width,this.editorHeight=e.scrollDOM.clientHeight,c|=16),l){let C=e.docView.measureVisibleLineHeights(this.viewport);if(n.mustRefreshForHeights(C)&&(o=!0),o||n.lineWrapping&&Math.abs(A-this.contentDOMWidth)>n.charWidth){let{lineHeight:E,charWidth:P,textHeight:O}=e.docView.measureTextSize();o=E>0&&n.refresh(r,E,P,O,Math.max(5,A/P),C),o&&(e.docView.minWidth=0,c|=16)}y>0&&_>0?h=Math.max(y,_):y<0&&_<0&&(h=Math.min(y,_)),Km();for(let E of this.viewports){let P=E.from==this.viewport.from?C:e.docView.measureVisibleLineHeights(E);this.heightMap=(o?ni.empty().applyChanges(this.stateDeco,be.empty,this.heightOracle,[new Oi(0,0,0,e.state.doc.length)]):this.heightMap).updateHeight(n,0,o,new Cu(E.from,P))}Ar&&(c|=2)}let T=!this.viewportIsAppropriate(this.viewport,h)||this.scrollTarget&&(this.scrollTarget.range.head<this.viewport.from||this.scrollTarget.range.head>this.viewport.to);return T&&(c&2&&(c|=this.updateScaler()),this.viewport=this.getViewport(h,this.scrollTarget),c|=this.updateForViewport()),(c&2||T)&&this.updateViewportLines(),(this.lineGaps.length||this.viewport.to-this.viewport.from>4e3)&&this.updateLineGaps(this.ensureLineGaps(o?[]:this.lineGaps,e)),c|=this.computeVisibleRanges(),this.mustEnforceCursorAssoc&&(this.mustEnforceCursorAssoc=!1,e.docView.enforceCursorAssoc()),c}get visibleTop(){return this.scaler.fromDOM(this.pixelViewport.top)}get visibleBottom(){return this.scaler.fromDOM(this.pixelViewport.bottom)}getViewport(e,t){let i=.5-Math.max(-.5,Math.min(.5,e/1e3/2)),n=this.heightMap,r=this.heightOracle,{visibleTop:o,visibleBottom:a}=this,l=new pr(n.lineAt(o-i*1e3,ze.ByHeight,r,0,0).from,n.lineAt(a+(1-i)*1e3,ze.ByHeight,r,0,0).to);if(t){let{head:c}=t.range;if(c<l.from||c>l.to){let h=Math.min(this.editorHeight,this.pixelViewport.bottom-this.pixelViewport.top),u=n.lineAt(c,ze.ByPos,r,0,0),f;t.y=="center"?f=(u.top+u.bottom)/2-h/2:t.y=="start"||t.y=="nearest"&&c<l.from?f=u.top:f=u.bottom-h,l=new pr(n.lineAt(f-1e3/2,ze.ByHeight,r,0,0).from,n.lineAt(f+h+1e3/2,ze.ByHeight,r,0,0).to)}}return l}mapViewport(e,t){let i=t.mapPos(e.from,-1),n=t.mapPos(e.to,1);return new pr(this.heightMap.lineAt(i,ze.ByPos,this.heightOracle,0,0).from,this.heightMap.lineAt(n,ze.ByPos,this.heightOracle,0,0).to)}viewportIsAppropriate({from:e,to:t},i=0){if(!this.inView)return!0;let{top:n}=this.heightMap.lineAt(e,ze.ByPos,this.heightOracle,0,0),{bottom:r}=this.heightMap.lineAt(t,ze.ByPos,this.heightOracle,0,0),{visibleTop:o,visibleBottom:a}=this;return(e==0||n<=o-Math.max(10,Math.min(-i,250)))&&(t==this.state.doc.length||r>=a+Math.max(10,Math.min(i,250)))&&n>o-2*1e3&&r<a+2*1e3}mapLineGaps(e,t){if(!e.length||t.empty)return e;let i=[];for(let n of e)t.touchesRange(n.from,n.to)||i.push(new Mo(t.mapPos(n.from),t.mapPos(n.to),n.size,n.displaySize));return i}ensureLineGaps(e,t){let i=this.heightOracle.lineWrapping,n=i?1e4:2e3,r=n>>1,o=n<<1;if(this.defaultTextDirection!=Ie.LTR&&!i)return[];let a=[],l=(h,u,f,d)=>{if(u-h<r)return;let m=this.state.selection.main,g=[m.from];m.empty||g.push(m.to);for(let _ of g)if(_>h&&_<u){l(h,_-10,f,d),l(_+10,u,f,d);return}let y=VS(e,_=>_.from>=f.from&&_.to<=f.to&&Math.abs(_.from-h)<r&&Math.abs(_.to-u)<r&&!g.some(w=>_.from<w&&_.to>w));if(!y){if(u<f.to&&t&&i&&t.visibleRanges.some(A=>A.from<=u&&A.to>=u)){let A=t.moveToLineBoundary(I.cursor(u),!1,!0).head;A>h&&(u=A)}let _=this.gapSize(f,h,u,d),w=i||_<2e6?_:2e6;y=new Mo(h,u,_,w)}a.push(y)},c=h=>{if(h.length<o||h.type!=Tt.Text)return;let u=zS(h.from,h.to,this.stateDeco);if(u.total<o)return;let f=this.scrollTarget?this.scrollTarget.range.head:null,d,m;if(i){let g=n/this.heightOracle.lineLength*this.heightOracle.lineHeight,y,_;if(f!=null){let w=Ga(u,f),A=((this.visibleBottom-this.visibleTop)/2+g)/h.height;y=w-A,_=w+A}else y=(this.visibleTop-h.top-g)/h.height,_=(this.visibleBottom-h.top+g)/h.height;d=Ha(u,y),m=Ha(u,_)}else{let g=u.total*this.heightOracle.charWidth,y=n*this.heightOracle.charWidth,_=0;if(g>2e6)for(let E of e)E.from>=h.from&&E.from<h.to&&E.size!=E.displaySize&&E.from*this.heightOracle.charWidth+_<this.pixelViewport.left&&(_=E.size-E.displaySize);let w=this.pixelViewport.left+_,A=this.pixelViewport.right+_,T,C;if(f!=null){let E=Ga(u,f),P=((A-w)/2+y)/g;T=E-P,C=E+P}else T=(w-y)/g,C=(A+y)/g;d=Ha(u,T),m=Ha(u,C)}d>h.from&&l(h.from,d,h,u),m<h.to&&l(m,h.to,h,u)};for(let h of this.viewportLines)Array.isArray(h.type)?h.type.forEach(c):c(h);return a}gapSize(e,t,i,n){let r=Ga(n,i)-Ga(n,t);return this.heightOracle.lineWrapping?e.height*r:n.total*this.heightOracle.charWidth*r}updateLineGaps(e){Mo.same(e,this.lineGaps)||(this.lineGaps=e,this.lineGapDeco=oe.set(e.map(t=>t.draw(this,this.heightOracle.lineWrapping))))}computeVisibleRanges(e){let t=this.stateDeco;this.lineGaps.length&&(t=t.concat(this.lineGapDeco));let i=[];Me.spans(t,this.viewport.from,this.viewport.to,{span(r,o){i.push({from:r,to:o})},point(){}},20);let n=0;if(i.length!=this.visibleRanges.length)n=12;else for(let r=0;r<i.length&&!(n&8);r++){let o=this.visibleRanges[r],a=i[r];(o.from!=a.from||o.to!=a.to)&&(n|=4,e&&e.mapPos(o.from,-1)==a.from&&e.mapPos(o.to,1)==a.to||(n|=8))}return this.visibleRanges=i,n}lineBlockAt(e){return e>=this.viewport.from&&e<=this.viewport.to&&this.viewportLines.find(t=>t.from<=e&&t.to>=e)||xo(this.heightMap.lineAt(e,ze.ByPos,this.heightOracle,0,0),this.scaler)}lineBlockAtHeight(e){return e>=this.viewportLines[0].top&&e<=this.viewportLines[this.viewportLines.length-1].bottom&&this.viewportLines.find(t=>t.top<=e&&t.bottom>=e)||xo(this.heightMap.lineAt(this.scaler.fromDOM(e),ze.ByHeight,this.heightOracle,0,0),this.scaler)}getScrollOffset(){return this.scrollParent==this.view.scrollDOM?this.scrollParent.scrollTop*this.scaleY:(this.scrollParent?this.scrollParent.getBoundingClientRect().top:0)-this.view.contentDOM.getBoundingClientRect().top}scrollAnchorAt(e){let t=this.lineBlockAtHeight(e+12-this.paddingTop);return t.from>=this.viewport.from||this.viewportLines[0].top-e>200?t:this.viewportLines[0]}elementAtHeight(e){return xo(this.heightMap.blockAt(this.scaler.fromDOM(e),this.heightOracle,0,0),this.scaler)}get docHeight(){return this.scaler.toDOM(this.heightMap.height)}get contentHeight(){return this.docHeight+this.paddingTop+this.paddingBottom}},pr=class{constructor(e,t){this.from=e,this.to=t}};function zS(s,e,t){let i=[],n=s,r=0;return Me.spans(t,s,e,{span(){},point(o,a){o>n&&(i.push({from:n,to:o}),r+=o-n),n=a}},20),n<e&&(i.push({from:n,to:e}),r+=e-n),{total:r,ranges:i}}function Ha({total:s,ranges:e},t){if(t<=0)return e[0].from;if(t>=1)return e[e.length-1].to;let i=Math.floor(s*t);for(let n=0;;n++){let{from:r,to:o}=e[n],a=o-r;if(i<=a)return r+i;i-=a}}function Ga(s,e){let t=0;for(let{from:i,to:n}of s.ranges){if(e<=n){t+=e-i;break}t+=n-i}return t/s.total}function VS(s,e){for(let t of s)if(e(t))return t}var Iu={toDOM(s){return s},fromDOM(s){return s},scale:1,eq(s){return s==this}};function Zm(s){let e=s.facet(gl).filter(i=>typeof i!="function"),t=s.facet(Qu).filter(i=>typeof i!="function");return t.length&&e.push(Me.join(t)),e}var Du=class s{constructor(e,t){this.scale=e,this.viewports=t}static get(e,t,i){let n=0,r=0,o=0,a=i.map(({from:c,to:h})=>{let u=t.lineAt(c,ze.ByPos,e,0,0).top,f=t.lineAt(h,ze.ByPos,e,0,0).bottom;return n+=f-u,{from:c,to:h,top:u,bottom:f,domTop:0,domBottom:0}});if(t.height-n<10)return Iu;let l=(7e6-n)/(t.height-n);for(let c of a)c.domTop=o+(c.top-r)*l,o=c.domBottom=c.domTop+(c.bottom-c.top),r=c.bottom;return new s(l,a)}toDOM(e){for(let t=0,i=0,n=0;;t++){let r=t<this.viewports.length?this.viewports[t]:null;if(!r||e<r.top)return n+(e-i)*this.scale;if(e<=r.bottom)return r.domTop+(e-r.top);i=r.bottom,n=r.domBottom}}fromDOM(e){for(let t=0,i=0,n=0;;t++){let r=t<this.viewports.length?this.viewports[t]:null;if(!r||e<r.domTop)return i+(e-n)/this.scale;if(e<=r.domBottom)return r.top+(e-r.domTop);i=r.bottom,n=r.domBottom}}eq(e){return e instanceof s?this.scale==e.scale&&this.viewports.length==e.viewports.length&&this.viewports.every((t,i)=>t.from==e.viewports[i].from&&t.to==e.viewports[i].to):!1}};function xo(s,e){if(e.scale==1)return s;let t=e.toDOM(s.top),i=e.toDOM(s.bottom);return new Ni(s.from,s.length,t,i-t,Array.isArray(s._content)?s._content.map(n=>xo(n,e)):s._content)}var Wa=$.define({combine:s=>s.join(" ")}),Nu=$.define({combine:s=>s.indexOf(!0)>-1}),Ou=yi.newName(),t0=yi.newName(),i0=yi.newName(),n0={"&light":"."+t0,"&dark":"."+i0};function Fu(s,e,t){return new yi(e,{finish(i){return/&/.test(i)?i.replace(/&\w*/,n=>{if(n=="&")return s;if(!t||!t[n])throw new RangeError(`Unsupported selector: ${n}`);return t[n]}):s+" "+i}})}var HS=Fu("."+Ou,{"&":{position:"relative !important",boxSizing:"border-box","&.cm-focused":{outline:"1px dotted #212121"},display:"flex !important",flexDirection:"column"},".cm-scroller":{display:"flex !important",alignItems:"flex-start !important",fontFamily:"monospace",lineHeight:1.4,height:"100%",overflowX:"auto",position:"relative",zIndex:0,overflowAnchor:"none"},".cm-content":{margin:0,flexGrow:2,flexShrink:0,display:"block",whiteSpace:"pre",wordWrap:"normal",boxSizing:"border-box",minHeight:"100%",padding:"4px 0",outline:"none","&[contenteditable=true]":{WebkitUserModify:"read-write-plaintext-only"}},".cm-lineWrapping":{whiteSpace_fallback:"pre-wrap",whiteSpace:"break-spaces",wordBreak:"break-word",overflowWrap:"anywhere",flexShrink:1},"&light .cm-content":{caretColor:"black"},"&dark .cm-content":{caretColor:"white"},".cm-line":{display:"block",padding:"0 2px 0 6px"},".cm-layer":{userSelect:"none",position:"absolute",left:0,top:0,contain:"size style","& > *":{position:"absolute"}},"&light .cm-selectionBackground":{background:"#d9d9d9"},"&dark .cm-selectionBackground":{background:"#222"},"&light.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground":{background:"#d7d4f0"},"&dark.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground":{background:"#233"},".cm-cursorLayer":{pointerEvents:"none"},"&.cm-focused > .cm-scroller > .cm-cursorLayer":{animation:"steps(1) cm-blink 1.2s infinite"},"@keyframes cm-blink":{"0%":{},"50%":{opacity:0},"100%":{}},"@keyframes cm-blink2":{"0%":{},"50%":{opacity:0},"100%":{}},".cm-cursor, .cm-dropCursor":{borderLeft:"1.2px solid black",marginLeft:"-0.6px",pointerEvents:"none"},".cm-cursor":{display:"none"},"&dark .cm-cursor":{borderLeftColor:"#ddd"},".cm-selectionHandle":{backgroundColor:"currentColor",width:"1.5px"},".cm-selectionHandle-start::before, .cm-selectionHandle-end::before":{content:'""',backgroundColor:"inherit",borderRadius:"50%",width:"8px",height:"8px",position:"absolute",left:"-3.25px"},".cm-selectionHandle-start::before":{top:"-8px"},".cm-selectionHandle-end::before":{bottom:"-8px"},".cm-dropCursor":{position:"absolute"},"&.cm-focused > .cm-scroller > .cm-cursorLayer .cm-cursor":{display:"block"},".cm-iso":{unicodeBidi:"isolate"},".cm-announced":{position:"fixed",top:"-10000px"},"@media print":{".cm-announced":{display:"none"}},"&light .cm-activeLine":{backgroundColor:"#cceeff44"},"&dark .cm-activeLine":{backgroundColor:"#99eeff33"},"&light .cm-specialChar":{color:"red"},"&dark .cm-specialChar":{color:"#f78"},".cm-gutters":{flexShrink:0,display:"flex",height:"100%",boxSizing:"border-box",zIndex:200},".cm-gutters-before":{insetInlineStart:0},".cm-gutters-after":{insetInlineEnd:0},"&light .cm-gutters":{backgroundColor:"#f5f5f5",color:"#6c6c6c",border:"0px solid #ddd","&.cm-gutters-before":{borderRightWidth:"1px"},"&.cm-gutters-after":{borderLeftWidth:"1px"}},"&dark .cm-gutters":{backgroundColor:"#333338",color:"#ccc"},".cm-gutter":{display:"flex !important",flexDirection:"column",flexShrink:0,boxSizing:"border-box",minHeight:"100%",overflow:"hidden"},".cm-gutterElement":{boxSizing:"border-box"},".cm-lineNumbers .cm-gutterElement":{padding:"0 3px 0 5px",minWidth:"20px",textAlign:"right",whiteSpace:"nowrap"},"&light .cm-activeLineGutter":{backgroundColor:"#e2f2ff"},"&dark .cm-activeLineGutter":{backgroundColor:"#222227"},".cm-panels":{boxSizing:"border-box",position:"sticky",left:0,right:0,zIndex:300},"&light .cm-panels":{backgroundColor:"#f5f5f5",color:"black"},".cm-panels-top":{top:"0"},".cm-panels-bottom":{bottom:"0"},"&light .cm-panels-top":{borderBottom:"1px solid #ddd"},"&light .cm-panels-bottom":{borderTop:"1px solid #ddd"},"&dark .cm-panels":{backgroundColor:"#333338",color:"white"},".cm-dialog":{padding:"2px 19px 4px 6px",position:"relative","& label":{fontSize:"80%"}},".cm-dialog-close":{position:"absolute",top:"3px",right:"4px",backgroundColor:"inherit",border:"none",font:"inherit",fontSize:"14px",padding:"0"},".cm-tab":{display:"inline-block",overflow:"hidden",verticalAlign:"bottom"},".cm-widgetBuffer":{verticalAlign:"baseline",height:"1em",width:0,display:"inline"},".cm-placeholder":{color:"#888",display:"inline-block",verticalAlign:"top",userSelect:"none"},".cm-highlightSpace":{background:"radial-gradient(circle at 50% 55%, #aaa 20%, transparent 0) no-repeat",backgroundSize:".4em",backgroundPosition:"calc(min(50%, 0px)) center"},".cm-highlightTab":{backgroundImage:`url('data:image/svg+xml,<svg xmlns="http://www.w3.org/2000/svg" width="200" height="20"><path stroke="%23888" stroke-width="1" fill="none" d="M1 10H196L190 5M190 15L196 10M197 4L197 16"/></svg>')`,backgroundSize:"auto 100%",backgroundPosition:"right 90%",backgroundRepeat:"no-repeat"},".cm-trailingSpace":{backgroundColor:"#ff332255"},".cm-button":{verticalAlign:"middle",color:"inherit",fontSize:"70%",padding:".2em 1em",borderRadius:"1px"},"&light .cm-button":{backgroundImage:"linear-gradient(#eff1f5, #d9d9df)",border:"1px solid #888","&:active":{backgroundImage:"linear-gradient(#b4b4b4, #d0d3d6)"}},"&dark .cm-button":{backgroundImage:"linear-gradient(#393939, #111)",border:"1px solid #888","&:active":{backgroundImage:"linear-gradient(#111, #333)"}},".cm-textfield":{verticalAlign:"middle",color:"inherit",fontSize:"70%",border:"1px solid silver",padding:".2em .5em"},"&light .cm-textfield":{backgroundColor:"white"},"&dark .cm-textfield":{border:"1px solid #555",backgroundColor:"inherit"}},n0),GS={childList:!0,characterData:!0,subtree:!0,attributes:!0,characterDataOldValue:!0},Jh=q.ie&&q.ie_version<=11,Bu=class{constructor(e){this.view=e,this.active=!1,this.editContext=null,this.selectionRange=new ru,this.selectionChanged=!1,this.delayedFlush=-1,this.resizeTimeout=-1,this.queue=[],this.delayedAndroidKey=null,this.flushingAndroidKey=-1,this.lastChange=0,this.scrollTargets=[],this.intersection=null,this.resizeScroll=null,this.intersecting=!1,this.gapIntersection=null,this.gaps=[],this.printQuery=null,this.parentCheck=-1,this.dom=e.contentDOM,this.observer=new MutationObserver(t=>{for(let i of t)this.queue.push(i);(q.ie&&q.ie_version<=11||q.ios&&e.composing)&&t.some(i=>i.type=="childList"&&i.removedNodes.length||i.type=="characterData"&&i.oldValue.length>i.target.nodeValue.length)?this.flushSoon():this.flush()}),window.EditContext&&q.android&&e.constructor.EDIT_CONTEXT!==!1&&!(q.chrome&&q.chrome_version<126)&&(this.editContext=new Uu(e),e.state.facet(xn)&&(e.contentDOM.editContext=this.editContext.editContext)),Jh&&(this.onCharData=t=>{this.queue.push({target:t.target,type:"characterData",oldValue:t.prevValue}),this.flushSoon()}),this.onSelectionChange=this.onSelectionChange.bind(this),this.onResize=this.onResize.bind(this),this.onPrint=this.onPrint.bind(this),this.onScroll=this.onScroll.bind(this),window.matchMedia&&(this.printQuery=window.matchMedia("print")),typeof ResizeObserver=="function"&&(this.resizeScroll=new ResizeObserver(()=>{var t;((t=this.view.docView)===null||t===void 0?void 0:t.lastUpdate)<Date.now()-75&&this.onResize()}),this.resizeScroll.observe(e.scrollDOM)),this.addWindowListeners(this.win=e.win),this.start(),typeof IntersectionObserver=="function"&&(this.intersection=new IntersectionObserver(t=>{this.parentCheck<0&&(this.parentCheck=setTimeout(this.listenForScroll.bind(this),1e3)),t.length>0&&t[t.length-1].intersectionRatio>0!=this.intersecting&&(this.intersecting=!this.intersecting,this.intersecting!=this.view.inView&&this.onScrollChanged(document.createEvent("Event")))},{threshold:[0,.001]}),this.intersection.observe(this.dom),this.gapIntersection=new IntersectionObserver(t=>{t.length>0&&t[t.length-1].intersectionRatio>0&&this.onScrollChanged(document.createEvent("Event"))},{})),this.listenForScroll(),this.readSelectionRange()}onScrollChanged(e){this.view.inputState.runHandlers("scroll",e),this.intersecting&&this.view.measure()}onScroll(e){this.intersecting&&this.flush(this.pendingRecords().length>0),this.editContext&&this.view.requestMeasure(this.editContext.measureReq),this.onScrollChanged(e)}onResize(){this.resizeTimeout<0&&(this.resizeTimeout=setTimeout(()=>{this.resizeTimeout=-1,this.view.requestMeasure()},50))}onPrint(e){(e.type=="change"||!e.type)&&!e.matches||(this.view.viewState.printing=!0,this.view.measure(),setTimeout(()=>{this.view.viewState.printing=!1,this.view.requestMeasure()},500))}updateGaps(e){if(this.gapIntersection&&(e.length!=this.gaps.length||this.gaps.some((t,i)=>t!=e[i]))){this.gapIntersection.disconnect();for(let t of e)this.gapIntersection.observe(t);this.gaps=e}}onSelectionChange(e){let t=this.selectionChanged;if(!this.readSelectionRange()||this.delayedAndroidKey)return;let{view:i}=this,n=this.selectionRange;if(i.state.facet(xn)?i.root.activeElement!=this.dom:!vo(this.dom,n))return;let r=n.anchorNode&&i.docView.tile.nearest(n.anchorNode);if(r&&r.isWidget()&&r.widget.ignoreEvent(e)){t||(this.selectionChanged=!1);return}(q.ie&&q.ie_version<=11||q.android&&q.chrome)&&!i.state.selection.main.empty&&n.focusNode&&yo(n.focusNode,n.focusOffset,n.anchorNode,n.anchorOffset)?this.flushSoon():this.flush(!1)}readSelectionRange(){let{view:e}=this,t=Ro(e.root);if(!t)return!1;let i=q.safari&&e.root.nodeType==11&&e.root.activeElement==this.dom&&WS(this.view,t)||t;if(!i||this.selectionRange.eq(i))return!1;let n=vo(this.dom,i);return n&&!this.selectionChanged&&e.inputState.lastFocusTime>Date.now()-200&&e.inputState.lastTouchTime<Date.now()-300&&B_(this.dom,i)?(this.view.inputState.lastFocusTime=0,e.docView.updateSelection(),!1):(this.selectionRange.setRange(i),n&&(this.selectionChanged=!0),!0)}setSelectionRange(e,t){this.selectionRange.set(e.node,e.offset,t.node,t.offset),this.selectionChanged=!1}clearSelectionRange(){this.selectionRange.set(null,0,null,0)}listenForScroll(){this.parentCheck=-1;let e=0,t=null;for(let i=this.dom;i;)if(bt(i))!t&&e<this.scrollTargets.length&&this.scrollTargets[e]==i?e++:t||(t=this.scrollTargets.slice(0,e)),t&&t.push(i),i=i.assignedSlot||i.parentNode;else if(i.nodeType==11)i=i.host;else break;if(e<this.scrollTargets.length&&!t&&(t=this.scrollTargets.slice(0,e)),t){for(let i of this.scrollTargets)i.removeEventListener("scroll",this.onScroll);for(let i of this.scrollTargets=t)i.addEventListener("scroll",this.onScroll)}}ignore(e){if(!this.active)return e();try{return this.stop(),e()}finally{this.start(),this.clear()}}start(){this.active||(this.observer.observe(this.dom,GS),Jh&&this.dom.addEventListener("DOMCharacterDataModified",this.onCharData),this.active=!0)}stop(){this.active&&(this.active=!1,this.observer.disconnect(),Jh&&this.dom.removeEventListener("DOMCharacterDataModified",this.onCharData))}clear(){this.processRecords(),this.queue.length=0,this.selectionChanged=!1}delayAndroidKey(e,t){var i;if(!this.delayedAndroidKey){let n=()=>{let r=this.delayedAndroidKey;r&&(this.clearDelayedAndroidKey(),this.view.inputState.lastKeyCode=r.keyCode,this.view.inputState.lastKeyTime=Date.now(),!this.flush()&&r.force&&vr(this.dom,r.key,r.keyCode))};this.flushingAndroidKey=this.view.win.requestAnimationFrame(n)}(!this.delayedAndroidKey||e=="Enter")&&(this.delayedAndroidKey={key:e,keyCode:t,force:this.lastChange<Date.now()-50||!!(!((i=this.delayedAndroidKey)===null||i===void 0)&&i.force)})}clearDelayedAndroidKey(){this.win.cancelAnimationFrame(this.flushingAndroidKey),this.delayedAndroidKey=null,this.flushingAndroidKey=-1}flushSoon(){this.delayedFlush<0&&(this.delayedFlush=this.view.win.requestAnimationFrame(()=>{this.delayedFlush=-1,this.flush()}))}forceFlush(){this.delayedFlush>=0&&(this.view.win.cancelAnimationFrame(this.delayedFlush),this.delayedFlush=-1),this.flush()}pendingRecords(){for(let e of this.observer.takeRecords())this.queue.push(e);return this.queue}processRecords(){let e=this.pendingRecords();e.length&&(this.queue=[]);let t=-1,i=-1,n=!1;for(let r of e){let o=this.readMutation(r);o&&(o.typeOver&&(n=!0),t==-1?{from:t,to:i}=o:(t=Math.min(o.from,t),i=Math.max(o.to,i)))}return{from:t,to:i,typeOver:n}}readChange(){let{from:e,to:t,typeOver:i}=this.processRecords(),n=this.selectionChanged&&vo(this.dom,this.selectionRange);if(e<0&&!n)return null;e>-1&&(this.lastChange=Date.now()),this.view.inputState.lastFocusTime=0,this.selectionChanged=!1;let r=new Su(this.view,e,t,i);return this.view.docView.domChanged={newSel:r.newSel?r.newSel.main:null},r}flush(e=!0){if(this.delayedFlush>=0||this.delayedAndroidKey)return!1;e&&this.readSelectionRange();let t=this.selectionChanged,i=this.readChange();if(!i)return this.view.requestMeasure(),!1;let n=this.view.state,r=qg(this.view,i);return this.view.state==n&&(i.domChanged||t)&&this.view.update([]),r}readMutation(e){let t=this.view.docView.tile.nearest(e.target);if(!t||t.isWidget())return null;if(t.markDirty(e.type=="attributes"),e.type=="childList"){let i=jm(t,e.previousSibling||e.target.previousSibling,-1),n=jm(t,e.nextSibling||e.target.nextSibling,1);return{from:i?t.posAfter(i):t.posAtStart,to:n?t.posBefore(n):t.posAtEnd,typeOver:!1}}else return e.type=="characterData"?{from:t.posAtStart,to:t.posAtEnd,typeOver:e.target.nodeValue==e.oldValue}:null}setWindow(e){e!=this.win&&(this.removeWindowListeners(this.win),this.win=e,this.addWindowListeners(this.win))}addWindowListeners(e){e.addEventListener("resize",this.onResize),this.printQuery?this.printQuery.addEventListener?this.printQuery.addEventListener("change",this.onPrint):this.printQuery.addListener(this.onPrint):e.addEventListener("beforeprint",this.onPrint),e.addEventListener("scroll",this.onScroll),e.document.addEventListener("selectionchange",this.onSelectionChange)}removeWindowListeners(e){e.removeEventListener("scroll",this.onScroll),e.removeEventListener("resize",this.onResize),this.printQuery?this.printQuery.removeEventListener?this.printQuery.removeEventListener("change",this.onPrint):this.printQuery.removeListener(this.onPrint):e.removeEventListener("beforeprint",this.onPrint),e.document.removeEventListener("selectionchange",this.onSelectionChange)}update(e){this.editContext&&(this.editContext.update(e),e.startState.facet(xn)!=e.state.facet(xn)&&(e.view.contentDOM.editContext=e.state.facet(xn)?this.editContext.editContext:null))}destroy(){var e,t,i;this.stop(),(e=this.intersection)===null||e===void 0||e.disconnect(),(t=this.gapIntersection)===null||t===void 0||t.disconnect(),(i=this.resizeScroll)===null||i===void 0||i.disconnect();for(let n of this.scrollTargets)n.removeEventListener("scroll",this.onScroll);this.removeWindowListeners(this.win),clearTimeout(this.parentCheck),clearTimeout(this.resizeTimeout),this.win.cancelAnimationFrame(this.delayedFlush),this.win.cancelAnimationFrame(this.flushingAndroidKey),this.editContext&&(this.view.contentDOM.editContext=null,this.editContext.destroy())}};function jm(s,e,t){for(;e;){let i=Ke.get(e);if(i&&i.parent==s)return i;let n=e.parentNode;e=n!=s.dom?n:t>0?e.nextSibling:e.previousSibling}return null}function Qm(s,e){let t=e.startContainer,i=e.startOffset,n=e.endContainer,r=e.endOffset,o=s.docView.domAtPos(s.state.selection.main.anchor,1);return yo(o.node,o.offset,n,r)&&([t,i,n,r]=[n,r,t,i]),{anchorNode:t,anchorOffset:i,focusNode:n,focusOffset:r}}function WS(s,e){if(e.getComposedRanges){let n=e.getComposedRanges(s.root)[0];if(n)return Qm(s,n)}let t=null;function i(n){n.preventDefault(),n.stopImmediatePropagation(),t=n.getTargetRanges()[0]}return s.contentDOM.addEventListener("beforeinput",i,!0),s.dom.ownerDocument.execCommand("indent"),s.contentDOM.removeEventListener("beforeinput",i,!0),t?Qm(s,t):null}var Uu=class{constructor(e){this.from=0,this.to=0,this.pendingContextChange=null,this.handlers=Object.create(null),this.composing=null,this.resetRange(e.state);let t=this.editContext=new window.EditContext({text:e.state.doc.sliceString(this.from,this.to),selectionStart:this.toContextPos(Math.max(this.from,Math.min(this.to,e.state.selection.main.anchor))),selectionEnd:this.toContextPos(e.state.selection.main.head)});this.handlers.textupdate=i=>{let n=e.state.selection.main,{anchor:r,head:o}=n,a=this.toEditorPos(i.updateRangeStart),l=this.toEditorPos(i.updateRangeEnd);e.inputState.composing>=0&&!this.composing&&(this.composing={contextBase:i.updateRangeStart,editorBase:a,drifted:!1});let c=l-a>i.text.length;a==this.from&&r<this.from?a=r:l==this.to&&r>this.to&&(l=r);let h=Xg(e.state.sliceDoc(a,l),i.text,(c?n.from:n.to)-a,c?"end":null);if(!h){let f=I.single(this.toEditorPos(i.selectionStart),this.toEditorPos(i.selectionEnd));wu(f,n)||e.dispatch({selection:f,userEvent:"select"});return}let u={from:h.from+a,to:h.toA+a,insert:be.of(i.text.slice(h.from,h.toB).split(`
`))};if((q.mac||q.android)&&u.from==o-1&&/^\. ?$/.test(i.text)&&e.contentDOM.getAttribute("autocorrect")=="off"&&(u={from:a,to:l,insert:be.of([i.text.replace("."," ")])}),this.pendingContextChange=u,!e.state.readOnly){let f=this.to-this.from+(u.to-u.from+u.insert.length);tf(e,u,I.single(this.toEditorPos(i.selectionStart,f),this.toEditorPos(i.selectionEnd,f)))}this.pendingContextChange&&(this.revertPending(e.state),this.setSelection(e.state)),u.from<u.to&&!u.insert.length&&e.inputState.composing>=0&&!/[\\p{Alphabetic}\\p{Number}_]/.test(t.text.slice(Math.max(0,i.updateRangeStart-1),Math.min(t.text.length,i.updateRangeStart+1)))&&this.handlers.compositionend(i)},this.handlers.characterboundsupdate=i=>{let n=[],r=null;for(let o=this.toEditorPos(i.rangeStart),a=this.toEditorPos(i.rangeEnd);o<a;o++){let l=e.coordsForChar(o);r=l&&new DOMRect(l.left,l.top,l.right-l.left,l.bottom-l.top)||r||new DOMRect,n.push(r)}t.updateCharacterBounds(i.rangeStart,n)},this.handlers.textformatupdate=i=>{let n=[];for(let r of i.getTextFormats()){let o=r.underlineStyle,a=r.underlineThickness;if(!/none/i.test(o)&&!/none/i.test(a)){let l=this.toEditorPos(r.rangeStart),c=this.toEditorPos(r.rangeEnd);if(l<c){let h=`text-decoration: underline ${/^[a-z]/.test(o)?o+" ":o=="Dashed"?"dashed ":o=="Squiggle"?"wavy ":""}${/thin/i.test(a)?1:2}px`;n.push(oe.mark({attributes:{style:h}}).range(l,c))}}}e.dispatch({effects:Ng.of(oe.set(n))})},this.handlers.compositionstart=()=>{e.inputState.composing<0&&(e.inputState.composing=0,e.inputState.compositionFirstChange=!0)},this.handlers.compositionend=()=>{if(e.inputState.composing=-1,e.inputState.compositionFirstChange=null,this.composing){let{drifted:i}=this.composing;this.composing=null,i&&this.reset(e.state)}};for(let i in this.handlers)t.addEventListener(i,this.handlers[i]);this.measureReq={read:i=>{let n=Ro(i.root);n&&n.rangeCount&&this.editContext.updateSelectionBounds(n.getRangeAt(0).getBoundingClientRect())}}}applyEdits(e){let t=0,i=!1,n=this.pendingContextChange;return e.changes.iterChanges((r,o,a,l,c)=>{if(i)return;let h=c.length-(o-r);if(n&&o>=n.to)if(n.from==r&&n.to==o&&n.insert.eq(c)){n=this.pendingContextChange=null,t+=h,this.to+=h;return}else n=null,this.revertPending(e.state);if(r+=t,o+=t,o<=this.from)this.from+=h,this.to+=h;else if(r<this.to){if(r<this.from||o>this.to||this.to-this.from+c.length>3e4){i=!0;return}this.editContext.updateText(this.toContextPos(r),this.toContextPos(o),c.toString()),this.to+=h}t+=h}),n&&!i&&this.revertPending(e.state),!i}update(e){let t=this.pendingContextChange,i=e.startState.selection.main;this.composing&&(this.composing.drifted||!e.changes.touchesRange(i.from,i.to)&&e.transactions.some(n=>!n.isUserEvent("input.type")&&n.changes.touchesRange(this.from,this.to)))?(this.composing.drifted=!0,this.composing.editorBase=e.changes.mapPos(this.composing.editorBase)):!this.applyEdits(e)||!this.rangeIsValid(e.state)?(this.pendingContextChange=null,this.reset(e.state)):(e.docChanged||e.selectionSet||t)&&this.setSelection(e.state),(e.geometryChanged||e.docChanged||e.selectionSet)&&e.view.requestMeasure(this.measureReq)}resetRange(e){let{head:t}=e.selection.main;this.from=Math.max(0,t-1e4),this.to=Math.min(e.doc.length,t+1e4)}reset(e){this.resetRange(e),this.editContext.updateText(0,this.editContext.text.length,e.doc.sliceString(this.from,this.to)),this.setSelection(e)}revertPending(e){let t=this.pendingContextChange;this.pendingContextChange=null,this.editContext.updateText(this.toContextPos(t.from),this.toContextPos(t.from+t.insert.length),e.doc.sliceString(t.from,t.to))}setSelection(e){let{main:t}=e.selection,i=this.toContextPos(Math.max(this.from,Math.min(this.to,t.anchor))),n=this.toContextPos(t.head);(this.editContext.selectionStart!=i||this.editContext.selectionEnd!=n)&&this.editContext.updateSelection(i,n)}rangeIsValid(e){let{head:t}=e.selection.main;return!(this.from>0&&t-this.from<500||this.to<e.doc.length&&this.to-t<500||this.to-this.from>1e4*3)}toEditorPos(e,t=this.to-this.from){e=Math.min(e,t);let i=this.composing;return i&&i.drifted?i.editorBase+(e-i.contextBase):e+this.from}toContextPos(e){let t=this.composing;return t&&t.drifted?t.contextBase+(e-t.editorBase):e-this.from}destroy(){for(let e in this.handlers)this.editContext.removeEventListener(e,this.handlers[e])}},ee=class s{get state(){return this.viewState.state}get viewport(){return this.viewState.viewport}get visibleRanges(){return this.viewState.visibleRanges}get inView(){return this.viewState.inView}get composing(){return!!this.inputState&&this.inputState.composing>0}get compositionStarted(){return!!this.inputState&&this.inputState.composing>=0}get root(){return this._root}get win(){return this.dom.ownerDocument.defaultView||window}constructor(e={}){var t;this.plugins=[],this.pluginMap=new Map,this.editorAttrs={},this.contentAttrs={},this.bidiCache=[],this.destroyed=!1,this.updateState=2,this.measureScheduled=-1,this.measureRequests=[],this.clearAnnouncement=-1,this.contentDOM=document.createElement("div"),this.scrollDOM=document.createElement("div"),this.scrollDOM.tabIndex=-1,this.scrollDOM.className="cm-scroller",this.scrollDOM.appendChild(this.contentDOM),this.announceDOM=document.createElement("div"),this.announceDOM.className="cm-announced",this.announceDOM.setAttribute("aria-live","polite"),this.dom=document.createElement("div"),this.dom.appendChild(this.announceDOM),this.dom.appendChild(this.scrollDOM),e.parent&&e.parent.appendChild(this.dom);let{dispatch:i}=e;this.dispatchTransactions=e.dispatchTransactions||i&&(n=>n.forEach(r=>i(r,this)))||(n=>this.update(n)),this.dispatch=this.dispatch.bind(this),this._root=e.root||F_(e.parent)||document,this.viewState=new ll(this,e.state||Ue.create(e)),e.scrollTo&&e.scrollTo.is(Ua)&&(this.viewState.scrollTarget=e.scrollTo.value.clip(this.viewState.state)),this.plugins=this.state.facet(dr).map(n=>new _o(n));for(let n of this.plugins)n.update(this);this.observer=new Bu(this),this.inputState=new Mu(this),this.inputState.ensureHandlers(this.plugins),this.docView=new sl(this),this.mountStyles(),this.updateAttrs(),this.updateState=0,this.requestMeasure(),!((t=document.fonts)===null||t===void 0)&&t.ready&&document.fonts.ready.then(()=>{this.viewState.mustMeasureContent="refresh",this.requestMeasure()})}dispatch(...e){let t=e.length==1&&e[0]instanceof ut?e:e.length==1&&Array.isArray(e[0])?e[0]:[this.state.update(...e)];this.dispatchTransactions(t,this)}update(e){if(this.updateState!=0)throw new Error("Calls to EditorView.update are not allowed while an update is in progress");let t=!1,i=!1,n,r=this.state;for(let f of e){if(f.startState!=r)throw new RangeError("Trying to update state with a transaction that doesn't start from the previous state.");r=f.state}if(this.destroyed){this.viewState.state=r;return}let o=this.hasFocus,a=0,l=null;e.some(f=>f.annotation(jg))?(this.inputState.notifiedFocused=o,a=1):o!=this.inputState.notifiedFocused&&(this.inputState.notifiedFocused=o,l=Qg(r,o),l||(a=1));let c=this.observer.delayedAndroidKey,h=null;if(c?(this.observer.clearDelayedAndroidKey(),h=this.observer.readChange(),(h&&!this.state.doc.eq(r.doc)||!this.state.selection.eq(r.selection))&&(h=null)):this.observer.clear(),r.facet(Ue.phrases)!=this.state.facet(Ue.phrases))return this.setState(r);n=il.create(this,r,e),n.flags|=a;let u=this.viewState.scrollTarget;try{this.updateState=2;for(let f of e){if(u&&(u=u.map(f.changes)),f.scrollIntoView){let{main:d}=f.state.selection,{x:m,y:g}=this.state.facet(s.cursorScrollMargin);u=new bo(d.empty?d:I.cursor(d.head,d.head>d.anchor?-1:1),"nearest","nearest",g,m)}for(let d of f.effects)d.is(Ua)&&(u=d.value.clip(this.state))}this.viewState.update(n,u),this.bidiCache=cl.update(this.bidiCache,n.changes),n.empty||(this.updatePlugins(n),this.inputState.update(n)),t=this.docView.update(n),this.state.facet(go)!=this.styleModules&&this.mountStyles(),i=this.updateAttrs(),this.showAnnouncements(e),this.docView.updateSelection(t,e.some(f=>f.isUserEvent("select.pointer")))}finally{this.updateState=0}if(n.startState.facet(Wa)!=n.state.facet(Wa)&&(this.viewState.mustMeasureContent=!0),(t||i||u||this.viewState.mustEnforceCursorAssoc||this.viewState.mustMeasureContent)&&this.requestMeasure(),t&&this.docViewUpdate(),!n.empty)for(let f of this.state.facet(cu))try{f(n)}catch(d){ii(this.state,d,"update listener")}(l||h)&&Promise.resolve().then(()=>{l&&this.state==l.startState&&this.dispatch(l),h&&!qg(this,h)&&c.force&&vr(this.contentDOM,c.key,c.keyCode)})}setState(e){if(this.updateState!=0)throw new Error("Calls to EditorView.setState are not allowed while an update is in progress");if(this.destroyed){this.viewState.state=e;return}this.updateState=2;let t=this.hasFocus;try{for(let i of this.plugins)i.destroy(this);this.viewState=new ll(this,e),this.plugins=e.facet(dr).map(i=>new _o(i)),this.pluginMap.clear();for(let i of this.plugins)i.update(this);this.docView.destroy(),this.docView=new sl(this),this.inputState.ensureHandlers(this.plugins),this.mountStyles(),this.updateAttrs(),this.bidiCache=[]}finally{this.updateState=0}t&&this.focus(),this.requestMeasure()}updatePlugins(e){let t=e.startState.facet(dr),i=e.state.facet(dr);if(t!=i){let n=[];for(let r of i){let o=t.indexOf(r);if(o<0)n.push(new _o(r));else{let a=this.plugins[o];a.mustUpdate=e,n.push(a)}}for(let r of this.plugins)r.mustUpdate!=e&&r.destroy(this);this.plugins=n,this.pluginMap.clear()}else for(let n of this.plugins)n.mustUpdate=e;for(let n=0;n<this.plugins.length;n++)this.plugins[n].update(this);t!=i&&this.inputState.ensureHandlers(this.plugins)}docViewUpdate(){for(let e of this.plugins){let t=e.value;if(t&&t.docViewUpdate)try{t.docViewUpdate(this)}catch(i){ii(this.state,i,"doc view update listener")}}}measure(e=!0){if(this.destroyed)return;if(this.measureScheduled>-1&&this.win.cancelAnimationFrame(this.measureScheduled),this.observer.delayedAndroidKey){this.measureScheduled=-1,this.requestMeasure();return}this.measureScheduled=0,e&&this.observer.forceFlush();let t=null,i=this.viewState.scrollParent,n=this.viewState.getScrollOffset(),{scrollAnchorPos:r,scrollAnchorHeight:o,scaleY:a}=this.viewState;Math.abs(n-this.viewState.scrollOffset)>1&&(o=-1),this.viewState.scrollAnchorHeight=-1;try{for(let l=0;;l++){if(o<0){if(vg(i||this.win))r=-1,o=this.viewState.heightMap.height/this.viewState.scaleY;else{let m=this.viewState.scrollAnchorAt(n);r=m.from,o=m.top}a=this.viewState.scaleY}this.updateState=1;let c=this.viewState.measure();if(!c&&!this.measureRequests.length&&this.viewState.scrollTarget==null)break;if(l>5){console.warn(this.measureRequests.length?"Measure loop restarted more than 5 times":"Viewport failed to stabilize");break}let h=[];c&4||([this.measureRequests,h]=[h,this.measureRequests]);let u=h.map(m=>{try{return m.read(this)}catch(g){return ii(this.state,g),eg}}),f=il.create(this,this.state,[]),d=!1;f.flags|=c,t?t.flags|=c:t=f,this.updateState=2,f.empty||(this.updatePlugins(f),this.inputState.update(f),this.updateAttrs(),d=this.docView.update(f),d&&this.docViewUpdate());for(let m=0;m<h.length;m++)if(u[m]!=eg)try{let g=h[m];g.write&&g.write(u[m],this)}catch(g){ii(this.state,g)}if(d&&this.docView.updateSelection(!0),!f.viewportChanged&&this.measureRequests.length==0){if(this.viewState.editorHeight)if(this.viewState.scrollTarget){this.docView.scrollIntoView(this.viewState.scrollTarget),this.viewState.scrollTarget=null,o=-1;continue}else{let g=(r<0?this.viewState.heightMap.height:this.viewState.lineBlockAt(r).top)/this.viewState.scaleY-o/a;if((g>1||g<-1)&&!(q.ios&&this.inputState.lastIOSMomentumScroll>Date.now()-100)&&(i==this.scrollDOM||this.hasFocus||Math.max(this.inputState.lastWheelEvent,this.inputState.lastTouchTime)>Date.now()-100)){n=n+g,i?r<0?i.scrollTop=i.scrollHeight:i.scrollTop+=g:this.win.scrollBy(0,g),o=-1;continue}}break}}}finally{this.updateState=0,this.measureScheduled=-1}if(t&&!t.empty)for(let l of this.state.facet(cu))l(t)}get themeClasses(){return Ou+" "+(this.state.facet(Nu)?i0:t0)+" "+this.state.facet(Wa)}updateAttrs(){let e=tg(this,Og,{class:"cm-editor"+(this.hasFocus?" cm-focused ":" ")+this.themeClasses}),t={spellcheck:"false",autocorrect:"off",autocapitalize:"off",writingsuggestions:"false",translate:"no",contenteditable:this.state.facet(xn)?"true":"false",class:"cm-content",style:`${q.tabSize}: ${this.state.tabSize}`,role:"textbox","aria-multiline":"true"};this.state.readOnly&&(t["aria-readonly"]="true"),tg(this,ju,t);let i=this.observer.ignore(()=>{let n=Dm(this.contentDOM,this.contentAttrs,t),r=Dm(this.dom,this.editorAttrs,e);return n||r});return this.editorAttrs=e,this.contentAttrs=t,i}showAnnouncements(e){let t=!0;for(let i of e)for(let n of i.effects)if(n.is(s.announce)){t&&(this.announceDOM.textContent="",this.win.clearTimeout(this.clearAnnouncement),this.clearAnnouncement=this.win.setTimeout(()=>{this.announceDOM.textContent=" "},200),t=!1);let r=this.announceDOM.appendChild(document.createElement("div"));r.textContent=n.value}}mountStyles(){this.styleModules=this.state.facet(go);let e=this.state.facet(s.cspNonce);yi.mount(this.root,this.styleModules.concat(HS).reverse(),e?{nonce:e}:void 0)}readMeasured(){if(this.updateState==2)throw new Error("Reading the editor layout isn't allowed during an update");this.updateState==0&&this.measureScheduled>-1&&this.measure(!1)}requestMeasure(e){if(this.measureScheduled<0&&(this.measureScheduled=this.win.requestAnimationFrame(()=>this.measure())),e){if(this.measureRequests.indexOf(e)>-1)return;if(e.key!=null){for(let t=0;t<this.measureRequests.length;t++)if(this.measureRequests[t].key===e.key){this.measureRequests[t]=e;return}}this.measureRequests.push(e)}}plugin(e){let t=this.pluginMap.get(e);return(t===void 0||t&&t.plugin!=e)&&this.pluginMap.set(e,t=this.plugins.find(i=>i.plugin==e)||null),t&&t.update(this).value}get documentTop(){return this.contentDOM.getBoundingClientRect().top+this.viewState.paddingTop}get documentPadding(){return{top:this.viewState.paddingTop,bottom:this.viewState.paddingBottom}}get scaleX(){return this.viewState.scaleX}get scaleY(){return this.viewState.scaleY}elementAtHeight(e){return this.readMeasured(),this.viewState.elementAtHeight(e)}lineBlockAtHeight(e){return this.readMeasured(),this.viewState.lineBlockAtHeight(e)}get viewportLineBlocks(){return this.viewState.viewportLines}lineBlockAt(e){return this.viewState.lineBlockAt(e)}get contentHeight(){return this.viewState.contentHeight}moveByChar(e,t,i){return Kh(this,e,zm(this,e,t,i))}moveByGroup(e,t){return Kh(this,e,zm(this,e,t,i=>fS(this,e.head,i)))}visualLineSide(e,t){return t?I.cursor(e.to,1):I.cursor(e.from,-1)}moveToLineBoundary(e,t,i=!0){return uS(this,e,t,i)}moveVertically(e,t,i){return Kh(this,e,dS(this,e,t,i))}domAtPos(e,t=1){return this.docView.domAtPos(e,t)}posAtDOM(e,t=0){return this.docView.posFromDOM(e,t)}posAtCoords(e,t=!0){this.readMeasured();let i=yu(this,e,t);return i&&i.pos}posAndSideAtCoords(e,t=!0){return this.readMeasured(),yu(this,e,t)}coordsAtPos(e,t=1){this.readMeasured();let i=this.state.doc.lineAt(e),n=this.bidiSpans(i),r=n[Si.find(n,e-i.from,-1,t)];return i.length&&(e==i.from&&t<0||e==i.to&&t>0)&&r.dir!=this.textDirectionAt(i.from)&&(e==i.to?(e=i.from+r.from,t=1):(e=i.from+r.to,t=-1)),this.docView.coordsAt(e,t,r.dir==Ie.RTL)}coordsForChar(e){return this.readMeasured(),this.docView.coordsForChar(e)}get defaultCharacterWidth(){return this.viewState.heightOracle.charWidth}get defaultLineHeight(){return this.viewState.heightOracle.lineHeight}get textDirection(){return this.viewState.defaultTextDirection}textDirectionAt(e){return!this.state.facet(Lg)||e<this.viewport.from||e>this.viewport.to?this.textDirection:(this.readMeasured(),this.docView.textDirectionAt(e))}get lineWrapping(){return this.viewState.heightOracle.lineWrapping}bidiSpans(e){if(e.length>qS)return Mg(e.length);let t=this.textDirectionAt(e.from),i;for(let r of this.bidiCache)if(r.from==e.from&&r.dir==t&&(r.fresh||wg(r.isolates,i=Fm(this,e))))return r.order;i||(i=Fm(this,e));let n=q_(e.text,t,i);return this.bidiCache.push(new cl(e.from,e.to,t,i,!0,n)),n}get hasFocus(){var e;return(this.dom.ownerDocument.hasFocus()||q.safari&&((e=this.inputState)===null||e===void 0?void 0:e.lastContextMenu)>Date.now()-3e4)&&this.root.activeElement==this.contentDOM}focus(){this.observer.ignore(()=>{xg(this.contentDOM),this.docView.updateSelection()})}setRoot(e){this._root!=e&&(this._root=e,this.observer.setWindow((e.nodeType==9?e:e.ownerDocument).defaultView||window),this.mountStyles())}destroy(){this.root.activeElement==this.contentDOM&&this.contentDOM.blur();for(let e of this.plugins)e.destroy(this);this.plugins=[],this.inputState.destroy(),this.docView.destroy(),this.dom.remove(),this.observer.destroy(),this.win.clearTimeout(this.clearAnnouncement),this.measureScheduled>-1&&this.win.cancelAnimationFrame(this.measureScheduled),this.destroyed=!0}static scrollIntoView(e,t={}){var i,n,r,o;return Ua.of(new bo(typeof e=="number"?I.cursor(e):e,(i=t.y)!==null&&i!==void 0?i:"nearest",(n=t.x)!==null&&n!==void 0?n:"nearest",(r=t.yMargin)!==null&&r!==void 0?r:5,(o=t.xMargin)!==null&&o!==void 0?o:5))}scrollSnapshot(){let{scrollTop:e,scrollLeft:t}=this.scrollDOM,i=this.viewState.scrollAnchorAt(e);return Ua.of(new bo(I.cursor(i.from),"start","start",i.top-e,t,!0))}setTabFocusMode(e){e==null?this.inputState.tabFocusMode=this.inputState.tabFocusMode<0?0:-1:typeof e=="boolean"?this.inputState.tabFocusMode=e?0:-1:this.inputState.tabFocusMode!=0&&(this.inputState.tabFocusMode=Date.now()+e)}static domEventHandlers(e){return _t.define(()=>({}),{eventHandlers:e})}static domEventObservers(e){return _t.define(()=>({}),{eventObservers:e})}static theme(e,t){let i=yi.newName(),n=[Wa.of(i),go.of(Fu(`.${i}`,e))];return t&&t.dark&&n.push(Nu.of(!0)),n}static baseTheme(e){return Dn.lowest(go.of(Fu("."+Ou,e,n0)))}static findFromDOM(e){var t;let i=e.querySelector(".cm-content"),n=i&&Ke.get(i)||Ke.get(e);return((t=n?.root)===null||t===void 0?void 0:t.view)||null}};ee.styleModule=go;ee.inputHandler=Pg;ee.clipboardInputFilter=Ju;ee.clipboardOutputFilter=Zu;ee.scrollHandler=Dg;ee.focusChangeEffect=kg;ee.perLineTextDirection=Lg;ee.exceptionSink=Rg;ee.updateListener=cu;ee.editable=xn;ee.mouseSelectionStyle=Cg;ee.dragMovesSelection=Eg;ee.clickAddsSelectionRange=Tg;ee.decorations=gl;ee.blockWrappers=Fg;ee.outerDecorations=Qu;ee.atomicRanges=ko;ee.bidiIsolatedRanges=Bg;ee.cursorScrollMargin=$.define({combine:s=>{let e=5,t=5;for(let i of s)typeof i=="number"?e=t=i:{x:e,y:t}=i;return{x:e,y:t}}});ee.scrollMargins=zg;ee.darkTheme=Nu;ee.cspNonce=$.define({combine:s=>s.length?s[0]:""});ee.contentAttributes=ju;ee.editorAttributes=Og;ee.lineWrapping=ee.contentAttributes.of({class:"cm-lineWrapping"});ee.announce=de.define();var qS=4096,eg={},cl=class s{constructor(e,t,i,n,r,o){this.from=e,this.to=t,this.dir=i,this.isolates=n,this.fresh=r,this.order=o}static update(e,t){if(t.empty&&!e.some(r=>r.fresh))return e;let i=[],n=e.length?e[e.length-1].dir:Ie.LTR;for(let r=Math.max(0,e.length-10);r<e.length;r++){let o=e[r];o.dir==n&&!t.touchesRange(o.from,o.to)&&i.push(new s(t.mapPos(o.from,1),t.mapPos(o.to,-1),o.dir,o.isolates,!1,o.order))}return i}};function tg(s,e,t){for(let i=s.state.facet(e),n=i.length-1;n>=0;n--){let r=i[n],o=typeof r=="function"?r(s):r;o&&$u(o,t)}return t}var XS=q.mac?"mac":q.windows?"win":q.linux?"linux":"key";function $S(s,e){let t=s.split(/-(?!$)/),i=t[t.length-1];i=="Space"&&(i=" ");let n,r,o,a;for(let l=0;l<t.length-1;++l){let c=t[l];if(/^(cmd|meta|m)$/i.test(c))a=!0;else if(/^a(lt)?$/i.test(c))n=!0;else if(/^(c|ctrl|control)$/i.test(c))r=!0;else if(/^s(hift)?$/i.test(c))o=!0;else if(/^mod$/i.test(c))e=="mac"?a=!0:r=!0;else throw new Error("Unrecognized modifier name: "+c)}return n&&(i="Alt-"+i),r&&(i="Ctrl-"+i),a&&(i="Meta-"+i),o&&(i="Shift-"+i),i}function qa(s,e,t){return e.altKey&&(s="Alt-"+s),e.ctrlKey&&(s="Ctrl-"+s),e.metaKey&&(s="Meta-"+s),t!==!1&&e.shiftKey&&(s="Shift-"+s),s}var YS=Dn.default(ee.domEventHandlers({keydown(s,e){return o0(s0(e.state),s,e,"editor")}})),nf=$.define({enables:YS}),ig=new WeakMap;function s0(s){let e=s.facet(nf),t=ig.get(e);return t||ig.set(e,t=JS(e.reduce((i,n)=>i.concat(n),[]))),t}function r0(s,e,t){return o0(s0(s.state),e,s,t)}var Nn=null,KS=4e3;function JS(s,e=XS){let t=Object.create(null),i=Object.create(null),n=(o,a)=>{let l=i[o];if(l==null)i[o]=a;else if(l!=a)throw new Error("Key binding "+o+" is used both as a regular binding and as a multi-stroke prefix")},r=(o,a,l,c,h)=>{var u,f;let d=t[o]||(t[o]=Object.create(null)),m=a.split(/ (?!$)/).map(_=>$S(_,e));for(let _=1;_<m.length;_++){let w=m.slice(0,_).join(" ");n(w,!0),d[w]||(d[w]={preventDefault:!0,stopPropagation:!1,run:[A=>{let T=Nn={view:A,prefix:w,scope:o};return setTimeout(()=>{Nn==T&&(Nn=null)},KS),!0}]})}let g=m.join(" ");n(g,!1);let y=d[g]||(d[g]={preventDefault:!1,stopPropagation:!1,run:((f=(u=d._any)===null||u===void 0?void 0:u.run)===null||f===void 0?void 0:f.slice())||[]});l&&y.run.push(l),c&&(y.preventDefault=!0),h&&(y.stopPropagation=!0)};for(let o of s){let a=o.scope?o.scope.split(" "):["editor"];if(o.any)for(let c of a){let h=t[c]||(t[c]=Object.create(null));h._any||(h._any={preventDefault:!1,stopPropagation:!1,run:[]});let{any:u}=o;for(let f in h)h[f].run.push(d=>u(d,zu))}let l=o[e]||o.key;if(l)for(let c of a)r(c,l,o.run,o.preventDefault,o.stopPropagation),o.shift&&r(c,"Shift-"+l,o.shift,o.preventDefault,o.stopPropagation)}return t}var zu=null;function o0(s,e,t,i){zu=e;let n=Rm(e),r=Oa(n,0),o=Fa(r)==n.length&&n!=" ",a="",l=!1,c=!1,h=!1;Nn&&Nn.view==t&&Nn.scope==i&&(a=Nn.prefix+" ",Yg.indexOf(e.keyCode)<0&&(c=!0,Nn=null));let u=new Set,f=y=>{if(y){for(let _ of y.run)if(!u.has(_)&&(u.add(_),_(t)))return y.stopPropagation&&(h=!0),!0;y.preventDefault&&(y.stopPropagation&&(h=!0),c=!0)}return!1},d=s[i],m,g;return d&&(f(d[a+qa(n,e,!o)])?l=!0:o&&(e.altKey||e.metaKey||e.ctrlKey)&&!(q.windows&&e.ctrlKey&&e.altKey)&&!(q.mac&&e.altKey&&!(e.ctrlKey||e.metaKey))&&(m=gn[e.keyCode])&&m!=n?(f(d[a+qa(m,e,!0)])||e.shiftKey&&(g=ur[e.keyCode])!=n&&g!=m&&f(d[a+qa(g,e,!1)]))&&(l=!0):o&&e.shiftKey&&f(d[a+qa(n,e,!0)])&&(l=!0),!l&&f(d._any)&&(l=!0)),c&&(l=!0),l&&h&&e.stopPropagation(),zu=null,l}var xs=class s{constructor(e,t,i,n,r){this.className=e,this.left=t,this.top=i,this.width=n,this.height=r}draw(){let e=document.createElement("div");return e.className=this.className,this.adjust(e),e}update(e,t){return t.className!=this.className?!1:(this.adjust(e),!0)}adjust(e){e.style.left=this.left+"px",e.style.top=this.top+"px",this.width!=null&&(e.style.width=this.width+"px"),e.style.height=this.height+"px"}eq(e){return this.left==e.left&&this.top==e.top&&this.width==e.width&&this.height==e.height&&this.className==e.className}static forRange(e,t,i){if(i.empty){let n=e.coordsAtPos(i.head,i.assoc||1);if(!n)return[];let r=a0(e);return[new s(t,n.left-r.left,n.top-r.top,null,n.bottom-n.top)]}else return ZS(e,t,i)}};function a0(s){let e=s.scrollDOM.getBoundingClientRect();return{left:(s.textDirection==Ie.LTR?e.left:e.right-s.scrollDOM.clientWidth*s.scaleX)-s.scrollDOM.scrollLeft*s.scaleX,top:e.top-s.scrollDOM.scrollTop*s.scaleY}}function ng(s,e,t,i){let n=s.coordsAtPos(e,t*2);if(!n)return i;let r=s.dom.getBoundingClientRect(),o=(n.top+n.bottom)/2,a=s.posAtCoords({x:r.left+1,y:o}),l=s.posAtCoords({x:r.right-1,y:o});return a==null||l==null?i:{from:Math.max(i.from,Math.min(a,l)),to:Math.min(i.to,Math.max(a,l))}}function ZS(s,e,t){if(t.to<=s.viewport.from||t.from>=s.viewport.to)return[];let i=Math.max(t.from,s.viewport.from),n=Math.min(t.to,s.viewport.to),r=s.textDirection==Ie.LTR,o=s.contentDOM,a=o.getBoundingClientRect(),l=a0(s),c=o.querySelector(".cm-line"),h=c&&window.getComputedStyle(c),u=a.left+(h?parseInt(h.paddingLeft)+Math.min(0,parseInt(h.textIndent)):0),f=a.right-(h?parseInt(h.paddingRight):0),d=vu(s,i,1),m=vu(s,n,-1),g=d.type==Tt.Text?d:null,y=m.type==Tt.Text?m:null;if(g&&(s.lineWrapping||d.widgetLineBreaks)&&(g=ng(s,i,1,g)),y&&(s.lineWrapping||m.widgetLineBreaks)&&(y=ng(s,n,-1,y)),g&&y&&g.from==y.from&&g.to==y.to)return w(A(t.from,t.to,g));{let C=g?A(t.from,null,g):T(d,!1),E=y?A(null,t.to,y):T(m,!0),P=[];return(g||d).to<(y||m).from-(g&&y?1:0)||d.widgetLineBreaks>1&&C.bottom+s.defaultLineHeight/2<E.top?P.push(_(u,C.bottom,f,E.top)):C.bottom<E.top&&s.elementAtHeight((C.bottom+E.top)/2).type==Tt.Text&&(C.bottom=E.top=(C.bottom+E.top)/2),w(C).concat(P).concat(w(E))}function _(C,E,P,O){return new xs(e,C-l.left,E-l.top,Math.max(0,P-C),O-E)}function w({top:C,bottom:E,horizontal:P}){let O=[];for(let H=0;H<P.length;H+=2)O.push(_(P[H],C,P[H+1],E));return O}function A(C,E,P){let O=1e9,H=-1e9,G=[];function k(V,N,ie,X,Pe){let ce=s.coordsAtPos(V,V==P.to?-2:2),ae=s.coordsAtPos(ie,ie==P.from?2:-2);!ce||!ae||(O=Math.min(ce.top,ae.top,O),H=Math.max(ce.bottom,ae.bottom,H),Pe==Ie.LTR?G.push(r&&N?u:ce.left,r&&X?f:ae.right):G.push(!r&&X?u:ae.left,!r&&N?f:ce.right))}let D=C??P.from,F=E??P.to;for(let V of s.visibleRanges)if(V.to>D&&V.from<F)for(let N=Math.max(V.from,D),ie=Math.min(V.to,F);;){let X=s.state.doc.lineAt(N);for(let Pe of s.bidiSpans(X)){let ce=Pe.from+X.from,ae=Pe.to+X.from;if(ce>=ie)break;ae>N&&k(Math.max(ce,N),C==null&&ce<=D,Math.min(ae,ie),E==null&&ae>=F,Pe.dir)}if(N=X.to+1,N>=ie)break}return G.length==0&&k(D,C==null,F,E==null,s.textDirection),{top:O,bottom:H,horizontal:G}}function T(C,E){let P=a.top+(E?C.top:C.bottom);return{top:P,bottom:P,horizontal:[]}}}function jS(s,e){return s.constructor==e.constructor&&s.eq(e)}var Vu=class{constructor(e,t){this.view=e,this.layer=t,this.drawn=[],this.scaleX=1,this.scaleY=1,this.measureReq={read:this.measure.bind(this),write:this.draw.bind(this)},this.dom=e.scrollDOM.appendChild(document.createElement("div")),this.dom.classList.add("cm-layer"),t.above&&this.dom.classList.add("cm-layer-above"),t.class&&this.dom.classList.add(t.class),this.scale(),this.dom.setAttribute("aria-hidden","true"),this.setOrder(e.state),e.requestMeasure(this.measureReq),t.mount&&t.mount(this.dom,e)}update(e){e.startState.facet(Ja)!=e.state.facet(Ja)&&this.setOrder(e.state),(this.layer.update(e,this.dom)||e.geometryChanged)&&(this.scale(),e.view.requestMeasure(this.measureReq))}docViewUpdate(e){this.layer.updateOnDocViewUpdate!==!1&&e.requestMeasure(this.measureReq)}setOrder(e){let t=0,i=e.facet(Ja);for(;t<i.length&&i[t]!=this.layer;)t++;this.dom.style.zIndex=String((this.layer.above?150:-1)-t)}measure(){return this.layer.markers(this.view)}scale(){let{scaleX:e,scaleY:t}=this.view;(e!=this.scaleX||t!=this.scaleY)&&(this.scaleX=e,this.scaleY=t,this.dom.style.transform=`scale(${1/e}, ${1/t})`)}draw(e){if(e.length!=this.drawn.length||e.some((t,i)=>!jS(t,this.drawn[i]))){let t=this.dom.firstChild,i=0;for(let n of e)n.update&&t&&n.constructor&&this.drawn[i].constructor&&n.update(t,this.drawn[i])?(t=t.nextSibling,i++):this.dom.insertBefore(n.draw(),t);for(;t;){let n=t.nextSibling;t.remove(),t=n}this.drawn=e,q.webkit&&(this.dom.style.display=this.dom.firstChild?"":"none")}}destroy(){this.layer.destroy&&this.layer.destroy(this.dom,this.view),this.dom.remove()}},Ja=$.define();function l0(s){return[_t.define(e=>new Vu(e,s)),Ja.of(s)]}var Hu=!q.ios,Tr=$.define({combine(s){return vi(s,{cursorBlinkRate:1200,drawRangeCursor:!0,iosSelectionHandles:!0},{cursorBlinkRate:(e,t)=>Math.min(e,t),drawRangeCursor:(e,t)=>e||t})}});function c0(s={}){return[Tr.of(s),QS,ew,iw,Ig.of(!0)]}function h0(s){return s.startState.facet(Tr)!=s.state.facet(Tr)}var QS=l0({above:!0,markers(s){let{state:e}=s,t=e.facet(Tr),i=[];for(let n of e.selection.ranges){let r=n==e.selection.main;if(n.empty||t.drawRangeCursor&&!(r&&q.ios&&t.iosSelectionHandles)){let o=r?"cm-cursor cm-cursor-primary":"cm-cursor cm-cursor-secondary",a=n.empty?n:I.cursor(n.head,n.assoc);for(let l of xs.forRange(s,o,a))i.push(l)}}return i},update(s,e){s.transactions.some(i=>i.selection)&&(e.style.animationName=e.style.animationName=="cm-blink"?"cm-blink2":"cm-blink");let t=h0(s);return t&&sg(s.state,e),s.docChanged||s.selectionSet||t},mount(s,e){sg(e.state,s)},class:"cm-cursorLayer"});function sg(s,e){e.style.animationDuration=s.facet(Tr).cursorBlinkRate+"ms"}var ew=l0({above:!1,markers(s){let e=[],{main:t,ranges:i}=s.state.selection;for(let n of i)if(!n.empty&&(Hu||n!=t))for(let r of xs.forRange(s,"cm-selectionBackground",n))e.push(r);if(q.ios&&!t.empty&&s.state.facet(Tr).iosSelectionHandles){for(let n of xs.forRange(s,"cm-selectionHandle cm-selectionHandle-start",I.cursor(t.from,1)))e.push(n);for(let n of xs.forRange(s,"cm-selectionHandle cm-selectionHandle-end",I.cursor(t.to,1)))e.push(n)}return e},update(s,e){return s.docChanged||s.selectionSet||s.viewportChanged||h0(s)},class:"cm-selectionLayer"}),tw=q.gecko&&q.gecko_version==153?"#ffffff01":"transparent",iw=Dn.highest(ee.theme({".cm-line":{...Hu?{"& ::selection, &::selection":{backgroundColor:`${tw} !important`}}:{},caretColor:"transparent !important"},".cm-content":{caretColor:"transparent !important","& :focus":{caretColor:"initial !important",...Hu?{"&::selection, & ::selection":{backgroundColor:"Highlight !important"}}:{}}}}));var jP=/x/.unicode!=null?"gu":"g";function u0(){return sw}var nw=oe.line({class:"cm-activeLine"}),sw=_t.fromClass(class{constructor(s){this.decorations=this.getDeco(s)}update(s){(s.docChanged||s.selectionSet)&&(this.decorations=this.getDeco(s.view))}getDeco(s){let e=-1,t=[];for(let i of s.state.selection.ranges){let n=s.lineBlockAt(i.head);n.from>e&&(t.push(nw.range(n.from)),e=n.from)}return oe.set(t)}},{decorations:s=>s.decorations});var Xa="-10000px",hl=class{constructor(e,t,i,n){this.facet=t,this.createTooltipView=i,this.removeTooltipView=n,this.input=e.state.facet(t),this.tooltips=this.input.filter(o=>o);let r=null;this.tooltipViews=this.tooltips.map(o=>r=i(o,r))}update(e,t){var i;let n=e.state.facet(this.facet),r=n.filter(l=>l);if(n===this.input){for(let l of this.tooltipViews)l.update&&l.update(e);return!1}let o=[],a=t?[]:null;for(let l=0;l<r.length;l++){let c=r[l],h=-1;if(c){for(let u=0;u<this.tooltips.length;u++){let f=this.tooltips[u];f&&f.create==c.create&&(h=u)}if(h<0)o[l]=this.createTooltipView(c,l?o[l-1]:null),a&&(a[l]=!!c.above);else{let u=o[l]=this.tooltipViews[h];a&&(a[l]=t[h]),u.update&&u.update(e)}}}for(let l of this.tooltipViews)o.indexOf(l)<0&&(this.removeTooltipView(l),(i=l.destroy)===null||i===void 0||i.call(l));return t&&(a.forEach((l,c)=>t[c]=l),t.length=a.length),this.input=n,this.tooltips=r,this.tooltipViews=o,!0}};function f0(s){let e=s.dom.ownerDocument.documentElement,t=e.clientWidth,i=getComputedStyle(e);if(!/stable/.test(i.scrollbarGutter||""))return{left:0,right:t};let n=e.getBoundingClientRect(),r=s.win.scrollX;return{left:Math.max(0,n.left+r-parseFloat(i.marginLeft)),right:Math.min(t,n.right+r+parseFloat(i.marginRight))}}function rw(s){let{left:e,right:t}=f0(s);return{top:0,left:e,right:t,bottom:s.dom.ownerDocument.documentElement.clientHeight}}var Zh=$.define({combine:s=>{var e,t,i;return{position:q.ios?"absolute":((e=s.find(n=>n.position))===null||e===void 0?void 0:e.position)||"fixed",parent:((t=s.find(n=>n.parent))===null||t===void 0?void 0:t.parent)||null,tooltipSpace:((i=s.find(n=>n.tooltipSpace))===null||i===void 0?void 0:i.tooltipSpace)||rw}}}),rg=new WeakMap,d0=_t.fromClass(class{constructor(s){this.view=s,this.above=[],this.inView=!0,this.madeAbsolute=!1,this.lastTransaction=0,this.measureTimeout=-1;let e=s.state.facet(Zh);this.position=e.position,this.parent=e.parent,this.classes=s.themeClasses,this.createContainer(),this.measureReq={read:this.readMeasure.bind(this),write:this.writeMeasure.bind(this),key:this},this.resizeObserver=typeof ResizeObserver=="function"?new ResizeObserver(()=>this.measureSoon()):null,this.manager=new hl(s,vl,(t,i)=>this.createTooltip(t,i),t=>{this.resizeObserver&&this.resizeObserver.unobserve(t.dom),t.dom.remove()}),this.above=this.manager.tooltips.map(t=>!!t.above),this.intersectionObserver=typeof IntersectionObserver=="function"?new IntersectionObserver(t=>{Date.now()>this.lastTransaction-50&&t.length>0&&t[t.length-1].intersectionRatio<1&&this.measureSoon()},{threshold:[1]}):null,this.observeIntersection(),s.win.addEventListener("resize",this.measureSoon=this.measureSoon.bind(this)),this.maybeMeasure()}createContainer(){this.parent?(this.container=document.createElement("div"),this.container.style.position="relative",this.container.className=this.view.themeClasses,this.parent.appendChild(this.container)):this.container=this.view.dom}observeIntersection(){if(this.intersectionObserver){this.intersectionObserver.disconnect();for(let s of this.manager.tooltipViews)this.intersectionObserver.observe(s.dom)}}measureSoon(){this.measureTimeout<0&&(this.measureTimeout=setTimeout(()=>{this.measureTimeout=-1,this.maybeMeasure()},50))}update(s){s.transactions.length&&(this.lastTransaction=Date.now());let e=this.manager.update(s,this.above);e&&this.observeIntersection();let t=e||s.geometryChanged,i=s.state.facet(Zh);if(i.position!=this.position&&!this.madeAbsolute){this.position=i.position;for(let n of this.manager.tooltipViews)n.dom.style.position=this.position;t=!0}if(i.parent!=this.parent){this.parent&&this.container.remove(),this.parent=i.parent,this.createContainer();for(let n of this.manager.tooltipViews)this.container.appendChild(n.dom);t=!0}else this.parent&&this.view.themeClasses!=this.classes&&(this.classes=this.container.className=this.view.themeClasses);t&&this.maybeMeasure()}createTooltip(s,e){let t=s.create(this.view),i=e?e.dom:null;if(t.dom.classList.add("cm-tooltip"),s.arrow&&!t.dom.querySelector(".cm-tooltip > .cm-tooltip-arrow")){let n=document.createElement("div");n.className="cm-tooltip-arrow",t.dom.appendChild(n)}return t.dom.style.position=this.position,t.dom.style.top=Xa,t.dom.style.left="0px",this.container.insertBefore(t.dom,i),t.mount&&t.mount(this.view),this.resizeObserver&&this.resizeObserver.observe(t.dom),t}destroy(){var s,e,t;this.view.win.removeEventListener("resize",this.measureSoon);for(let i of this.manager.tooltipViews)i.dom.remove(),(s=i.destroy)===null||s===void 0||s.call(i);this.parent&&this.container.remove(),(e=this.resizeObserver)===null||e===void 0||e.disconnect(),(t=this.intersectionObserver)===null||t===void 0||t.disconnect(),clearTimeout(this.measureTimeout)}readMeasure(){let s=1,e=1,t=!1,i=0;if(this.position=="fixed"&&this.manager.tooltipViews.length){let{dom:o}=this.manager.tooltipViews[0];if(q.safari){let a=o.getBoundingClientRect();t=Math.abs(a.top+1e4)>1||Math.abs(a.left)>1}else t=!!o.offsetParent&&o.offsetParent!=this.container.ownerDocument.body}if(t||this.position=="absolute")if(this.parent){let o=this.parent.getBoundingClientRect();o.width&&o.height&&(s=o.width/this.parent.offsetWidth,e=o.height/this.parent.offsetHeight)}else({scaleX:s,scaleY:e}=this.view.viewState);else i=f0(this.view).left;let n=this.view.scrollDOM.getBoundingClientRect(),r=ef(this.view);return{visible:{left:n.left+r.left,top:n.top+r.top,right:n.right-r.right,bottom:n.bottom-r.bottom},parent:this.parent?this.container.getBoundingClientRect():this.view.dom.getBoundingClientRect(),pos:this.manager.tooltips.map((o,a)=>{let l=this.manager.tooltipViews[a];return l.getCoords?l.getCoords(o.pos):this.view.coordsAtPos(o.pos)}),size:this.manager.tooltipViews.map(({dom:o})=>o.getBoundingClientRect()),space:this.view.state.facet(Zh).tooltipSpace(this.view),scaleX:s,scaleY:e,makeAbsolute:t,fixedLeft:i}}writeMeasure(s){var e;if(s.makeAbsolute){this.madeAbsolute=!0,this.position="absolute";for(let a of this.manager.tooltipViews)a.dom.style.position="absolute"}let{visible:t,space:i,scaleX:n,scaleY:r}=s,o=[];for(let a=0;a<this.manager.tooltips.length;a++){let l=this.manager.tooltips[a],c=this.manager.tooltipViews[a],{dom:h}=c,u=s.pos[a],f=s.size[a];if(!u||l.clip!==!1&&(u.bottom<=Math.max(t.top,i.top)||u.top>=Math.min(t.bottom,i.bottom)||u.right<Math.max(t.left,i.left)-.1||u.left>Math.min(t.right,i.right)+.1)){h.style.top=Xa;continue}let d=l.arrow?c.dom.querySelector(".cm-tooltip-arrow"):null,m=d?7:0,g=f.right-f.left,y=(e=rg.get(c))!==null&&e!==void 0?e:f.bottom-f.top,_=c.offset||aw,w=this.view.textDirection==Ie.LTR,A=f.width>i.right-i.left?w?i.left:i.right-f.width:w?Math.max(i.left,Math.min(u.left-(d?14:0)+_.x,i.right-g)):Math.min(Math.max(i.left,u.left-g+(d?14:0)-_.x),i.right-g),T=this.above[a];!l.strictSide&&(T?u.top-y-m-_.y<i.top:u.bottom+y+m+_.y>i.bottom)&&T==i.bottom-u.bottom>u.top-i.top&&(T=this.above[a]=!T);let C=(T?u.top-i.top:i.bottom-u.bottom)-m;if(C<y&&c.resize!==!1){if(C<this.view.defaultLineHeight){h.style.top=Xa;continue}rg.set(c,y),h.style.height=(y=C)/r+"px"}else h.style.height&&(h.style.height="");let E=T?u.top-y-m-_.y:u.bottom+m+_.y,P=A+g;if(c.overlap!==!0)for(let O of o)O.left<P&&O.right>A&&O.top<E+y&&O.bottom>E&&(E=T?O.top-y-2-m:O.bottom+m+2);if(this.position=="absolute"?(h.style.top=(E-s.parent.top)/r+"px",og(h,(A-s.parent.left)/n)):(h.style.top=E/r+"px",og(h,(A-s.fixedLeft)/n)),d){let O=u.left+(w?_.x:-_.x)-(A+14-7);d.style.left=O/n+"px"}c.overlap!==!0&&o.push({left:A,top:E,right:P,bottom:E+y}),h.classList.toggle("cm-tooltip-above",T),h.classList.toggle("cm-tooltip-below",!T),c.positioned&&c.positioned(s.space)}}maybeMeasure(){if(this.manager.tooltips.length&&(this.view.inView&&this.view.requestMeasure(this.measureReq),this.inView!=this.view.inView&&(this.inView=this.view.inView,!this.inView)))for(let s of this.manager.tooltipViews)s.dom.style.top=Xa}},{eventObservers:{scroll(){this.maybeMeasure()}}});function og(s,e){let t=parseInt(s.style.left,10);(isNaN(t)||Math.abs(e-t)>1)&&(s.style.left=e+"px")}var ow=ee.baseTheme({".cm-tooltip":{zIndex:500,boxSizing:"border-box"},"&light .cm-tooltip":{border:"1px solid #bbb",backgroundColor:"#f5f5f5"},"&light .cm-tooltip-section:not(:first-child)":{borderTop:"1px solid #bbb"},"&dark .cm-tooltip":{backgroundColor:"#333338",color:"white"},".cm-tooltip-arrow":{height:"7px",width:"14px",position:"absolute",zIndex:-1,overflow:"hidden","&:before, &:after":{content:"''",position:"absolute",width:0,height:0,borderLeft:"7px solid transparent",borderRight:"7px solid transparent"},".cm-tooltip-above &":{bottom:"-7px","&:before":{borderTop:"7px solid #bbb"},"&:after":{borderTop:"7px solid #f5f5f5",bottom:"1px"}},".cm-tooltip-below &":{top:"-7px","&:before":{borderBottom:"7px solid #bbb"},"&:after":{borderBottom:"7px solid #f5f5f5",top:"1px"}}},"&dark .cm-tooltip .cm-tooltip-arrow":{"&:before":{borderTopColor:"#333338",borderBottomColor:"#333338"},"&:after":{borderTopColor:"transparent",borderBottomColor:"transparent"}}}),aw={x:0,y:0},vl=$.define({enables:[d0,ow]}),ul=$.define({combine:s=>s.reduce((e,t)=>e.concat(t),[])}),fl=class s{static create(e){return new s(e)}constructor(e){this.view=e,this.mounted=!1,this.dom=document.createElement("div"),this.dom.classList.add("cm-tooltip-hover"),this.manager=new hl(e,ul,(t,i)=>this.createHostedView(t,i),t=>t.dom.remove())}createHostedView(e,t){let i=e.create(this.view);return i.dom.classList.add("cm-tooltip-section"),this.dom.insertBefore(i.dom,t?t.dom.nextSibling:this.dom.firstChild),this.mounted&&i.mount&&i.mount(this.view),i}mount(e){for(let t of this.manager.tooltipViews)t.mount&&t.mount(e);this.mounted=!0}positioned(e){for(let t of this.manager.tooltipViews)t.positioned&&t.positioned(e)}update(e){this.manager.update(e)}destroy(){var e;for(let t of this.manager.tooltipViews)(e=t.destroy)===null||e===void 0||e.call(t)}passProp(e){let t;for(let i of this.manager.tooltipViews){let n=i[e];if(n!==void 0){if(t===void 0)t=n;else if(t!==n)return}}return t}get offset(){return this.passProp("offset")}get getCoords(){return this.passProp("getCoords")}get overlap(){return this.passProp("overlap")}get resize(){return this.passProp("resize")}},lw=vl.compute([ul],s=>{let e=s.facet(ul);return e.length===0?null:{pos:Math.min(...e.map(t=>t.pos)),end:Math.max(...e.map(t=>{var i;return(i=t.end)!==null&&i!==void 0?i:t.pos})),create:fl.create,above:e[0].above,arrow:e.some(t=>t.arrow)}}),cw=$.define(),Gu=class{constructor(e,t,i,n,r,o){this.view=e,this.source=t,this.field=i,this.locked=n,this.setHover=r,this.hoverTime=o,this.hoverTimeout=-1,this.restartTimeout=-1,this.pending=null,this.lastMove={x:0,y:0,target:e.dom,time:0},this.checkHover=this.checkHover.bind(this),e.dom.addEventListener("mouseleave",this.mouseleave=this.mouseleave.bind(this)),e.dom.addEventListener("mousemove",this.mousemove=this.mousemove.bind(this))}update(e){this.pending&&(this.pending=null,clearTimeout(this.restartTimeout),this.restartTimeout=setTimeout(()=>this.startHover(),20))}get active(){return this.view.state.field(this.field)}checkHover(){if(this.hoverTimeout=-1,this.active.length)return;let e=Date.now()-this.lastMove.time;e<this.hoverTime?this.hoverTimeout=setTimeout(this.checkHover,this.hoverTime-e):this.startHover()}startHover(){clearTimeout(this.restartTimeout);let{view:e,lastMove:t}=this,i=e.docView.tile.nearest(t.target);if(!i)return;let n,r=1;if(i.isWidget())n=i.posAtStart;else{if(n=e.posAtCoords(t),n==null)return;let o=e.coordsAtPos(n);if(!o||t.y<o.top||t.y>o.bottom||t.x<o.left-e.defaultCharacterWidth||t.x>o.right+e.defaultCharacterWidth)return;let a=e.bidiSpans(e.state.doc.lineAt(n)).find(c=>c.from<=n&&c.to>=n),l=a&&a.dir==Ie.RTL?-1:1;r=t.x<o.left?-l:l}this.activateHover(e,n,r)}activateHover(e,t,i,n){let r=this.source(e,t,i),o=a=>{if(a&&!(Array.isArray(a)&&!a.length)){let l=Array.isArray(a)?a:[a];n&&this.locked.set(l,n),e.dispatch({effects:this.setHover.of(l)})}};if(r&&"then"in r){let a=this.pending={pos:t};r.then(l=>{this.pending==a&&(this.pending=null,o(l))},l=>ii(e.state,l,"hover tooltip"))}else o(r)}get tooltip(){let e=this.view.plugin(d0),t=e?e.manager.tooltips.findIndex(i=>i.create==fl.create):-1;return t>-1?e.manager.tooltipViews[t]:null}mousemove(e){var t,i;this.lastMove={x:e.clientX,y:e.clientY,target:e.target,time:Date.now()},this.hoverTimeout<0&&(this.hoverTimeout=setTimeout(this.checkHover,this.hoverTime));let{active:n,tooltip:r}=this;if(n.length&&!this.locked.has(n)&&r&&!hw(r.dom,e)||this.pending){let{pos:o}=n[0]||this.pending,a=(i=(t=n[0])===null||t===void 0?void 0:t.end)!==null&&i!==void 0?i:o;(o==a?this.view.posAtCoords(this.lastMove)!=o:!uw(this.view,o,a,e.clientX,e.clientY))&&(this.view.dispatch({effects:this.setHover.of([])}),this.pending=null)}}mouseleave(e){clearTimeout(this.hoverTimeout),this.hoverTimeout=-1;let{active:t}=this;if(t.length&&!this.locked.has(t)){let{tooltip:i}=this;i&&i.dom.contains(e.relatedTarget)?this.watchTooltipLeave(i.dom):this.view.dispatch({effects:this.setHover.of([])})}}watchTooltipLeave(e){let t=i=>{e.removeEventListener("mouseleave",t);let{active:n}=this;n.length&&!this.locked.has(n)&&!this.view.dom.contains(i.relatedTarget)&&this.view.dispatch({effects:this.setHover.of([])})};e.addEventListener("mouseleave",t)}destroy(){clearTimeout(this.hoverTimeout),clearTimeout(this.restartTimeout),this.view.dom.removeEventListener("mouseleave",this.mouseleave),this.view.dom.removeEventListener("mousemove",this.mousemove)}},$a=4;function hw(s,e){let{left:t,right:i,top:n,bottom:r}=s.getBoundingClientRect(),o;if(o=s.querySelector(".cm-tooltip-arrow")){let a=o.getBoundingClientRect();n=Math.min(a.top,n),r=Math.max(a.bottom,r)}return e.clientX>=t-$a&&e.clientX<=i+$a&&e.clientY>=n-$a&&e.clientY<=r+$a}function uw(s,e,t,i,n,r){let o=s.scrollDOM.getBoundingClientRect(),a=s.documentTop+s.documentPadding.top+s.contentHeight;if(o.left>i||o.right<i||o.top>n||Math.min(o.bottom,a)<n)return!1;let l=s.posAtCoords({x:i,y:n},!1);return l>=e&&l<=t}function p0(s,e={}){let t=de.define(),i=new WeakMap,n=ot.define({create(){return[]},update(o,a){let l=i.get(o);if(o.length&&(e.hideOnChange&&(a.docChanged||a.selection)?o=[]:l&&l(a)?o=[]:e.hideOn&&(o=o.filter(c=>!e.hideOn(a,c)))),a.docChanged&&o.length){let c=[];for(let h of o){let u=a.changes.mapPos(h.pos,-1,Bt.TrackDel);if(u!=null){let f=Object.assign(Object.create(null),h);f.pos=u,f.end!=null&&(f.end=a.changes.mapPos(f.end)),c.push(f)}}o=c}for(let c of a.effects)c.is(t)&&(o=c.value,l=void 0),(c.is(fw)&&!c.value||c.value==n)&&(o=[]);return o.length&&l&&i.set(o,l),o},provide:o=>ul.from(o)}),r=_t.define(o=>new Gu(o,s,n,i,t,e.hoverTime||300));return{active:n,extension:[n,r,cw.of(r),lw]}}var fw=de.define();var ag=$.define({combine(s){let e,t;for(let i of s)e=e||i.topContainer,t=t||i.bottomContainer;return{topContainer:e,bottomContainer:t}}});function Lo(s,e){let t=s.plugin(m0),i=t?t.specs.indexOf(e):-1;return i>-1?t.panels[i]:null}var m0=_t.fromClass(class{constructor(s){this.input=s.state.facet(bs),this.specs=this.input.filter(t=>t),this.panels=this.specs.map(t=>t(s));let e=s.state.facet(ag);this.top=new mr(s,!0,e.topContainer),this.bottom=new mr(s,!1,e.bottomContainer),this.top.sync(this.panels.filter(t=>t.top)),this.bottom.sync(this.panels.filter(t=>!t.top));for(let t of this.panels)t.dom.classList.add("cm-panel"),t.mount&&t.mount()}update(s){let e=s.state.facet(ag);this.top.container!=e.topContainer&&(this.top.sync([]),this.top=new mr(s.view,!0,e.topContainer)),this.bottom.container!=e.bottomContainer&&(this.bottom.sync([]),this.bottom=new mr(s.view,!1,e.bottomContainer)),this.top.syncClasses(),this.bottom.syncClasses();let t=s.state.facet(bs);if(t!=this.input){let i=t.filter(l=>l),n=[],r=[],o=[],a=[];for(let l of i){let c=this.specs.indexOf(l),h;c<0?(h=l(s.view),a.push(h)):(h=this.panels[c],h.update&&h.update(s)),n.push(h),(h.top?r:o).push(h)}this.specs=i,this.panels=n,this.top.sync(r),this.bottom.sync(o);for(let l of a)l.dom.classList.add("cm-panel"),l.mount&&l.mount()}else for(let i of this.panels)i.update&&i.update(s)}destroy(){this.top.sync([]),this.bottom.sync([])}},{provide:s=>ee.scrollMargins.of(e=>{let t=e.plugin(s);return t&&{top:t.top.scrollMargin(),bottom:t.bottom.scrollMargin()}})}),mr=class{constructor(e,t,i){this.view=e,this.top=t,this.container=i,this.dom=void 0,this.classes="",this.panels=[],this.syncClasses()}sync(e){for(let t of this.panels)t.destroy&&e.indexOf(t)<0&&t.destroy();this.panels=e,this.syncDOM()}syncDOM(){if(this.panels.length==0){this.dom&&(this.dom.remove(),this.dom=void 0);return}if(!this.dom){this.dom=document.createElement("div"),this.dom.className=this.top?"cm-panels cm-panels-top":"cm-panels cm-panels-bottom";let t=this.container||this.view.dom;t.insertBefore(this.dom,this.top?t.firstChild:null)}let e=this.dom.firstChild;for(let t of this.panels)if(t.dom.parentNode==this.dom){for(;e!=t.dom;)e=lg(e);e=e.nextSibling}else this.dom.insertBefore(t.dom,e);for(;e;)e=lg(e)}scrollMargin(){return!this.dom||this.container?0:Math.max(0,this.top?this.dom.getBoundingClientRect().bottom-Math.max(0,this.view.scrollDOM.getBoundingClientRect().top):Math.min(innerHeight,this.view.scrollDOM.getBoundingClientRect().bottom)-this.dom.getBoundingClientRect().top)}syncClasses(){if(!(!this.container||this.classes==this.view.themeClasses)){for(let e of this.classes.split(" "))e&&this.container.classList.remove(e);for(let e of(this.classes=this.view.themeClasses).split(" "))e&&this.container.classList.add(e)}}};function lg(s){let e=s.nextSibling;return s.remove(),e}var bs=$.define({enables:m0});function g0(s,e){let t,i=new Promise(o=>t=o),n=o=>dw(o,e,t);s.state.field(Za,!1)?s.dispatch({effects:v0.of(n)}):s.dispatch({effects:de.appendConfig.of(Za.init(()=>[n]))});let r=y0.of(n);return{close:r,result:i.then(o=>((s.win.queueMicrotask||(l=>s.win.setTimeout(l,10)))(()=>{s.state.field(Za).indexOf(n)>-1&&s.dispatch({effects:r})}),o))}}function x0(s,e){let t=s.state.field(Za,!1)||[];for(let i of t){let n=Lo(s,i);if(n&&n.dom.classList.contains(e))return n}return null}var Za=ot.define({create(){return[]},update(s,e){for(let t of e.effects)t.is(v0)?s=[t.value].concat(s):t.is(y0)&&(s=s.filter(i=>i!=t.value));return s},provide:s=>bs.computeN([s],e=>e.field(s))}),v0=de.define(),y0=de.define();function dw(s,e,t){let i=e.content?e.content(s,()=>a(null)):null;if(!i){if(i=Ae("form"),e.input){let l=Ae("input",e.input);/^(text|password|number|email|tel|url)$/.test(l.type)&&l.classList.add("cm-textfield"),l.name||(l.name="input"),i.appendChild(Ae("label",(e.label||"")+": ",l))}else i.appendChild(document.createTextNode(e.label||""));i.appendChild(document.createTextNode(" ")),i.appendChild(Ae("button",{class:"cm-button",type:"submit"},e.submitLabel||"OK"))}let n=i.nodeName=="FORM"?[i]:i.querySelectorAll("form");for(let l=0;l<n.length;l++){let c=n[l];c.addEventListener("keydown",h=>{h.keyCode==27?(h.preventDefault(),a(null)):h.keyCode==13&&(h.preventDefault(),a(c))}),c.addEventListener("submit",h=>{h.preventDefault(),a(c)})}let r=Ae("div",i,Ae("button",{onclick:()=>a(null),"aria-label":s.state.phrase("close"),class:"cm-dialog-close",type:"button"},["×"]));e.class&&(r.className=e.class),r.classList.add("cm-dialog");let o=typeof e.focus=="string"?i.querySelector(e.focus):e.focus?i.querySelector("input")||i.querySelector("button"):null;function a(l){r.contains(r.ownerDocument.activeElement)&&s.focus(),t(l)}return{dom:r,top:e.top,mount:()=>{o&&("select"in o?o.select():"focus"in o&&o.focus())},destroy:()=>t(null)}}var wi=class extends nn{compare(e){return this==e||this.constructor==e.constructor&&this.eq(e)}eq(e){return!1}destroy(e){}};wi.prototype.elementClass="";wi.prototype.toDOM=void 0;wi.prototype.mapMode=Bt.TrackBefore;wi.prototype.startSide=wi.prototype.endSide=-1;wi.prototype.point=!0;var jh=$.define(),pw=$.define(),mw={class:"",renderEmptyElements:!1,elementStyle:"",markers:()=>Me.empty,lineMarker:()=>null,widgetMarker:()=>null,lineMarkerChange:null,initialSpacer:null,updateSpacer:null,domEventHandlers:{},side:"before"},Ao=$.define();function sf(s){return[b0(),Ao.of({...mw,...s})]}var Wu=$.define({combine:s=>s.some(e=>e)});function b0(s){let e=[gw];return s&&s.fixed===!1&&e.push(Wu.of(!0)),e}var gw=_t.fromClass(class{constructor(s){this.view=s,this.domAfter=null,this.prevViewport=s.viewport,this.dom=document.createElement("div"),this.dom.className="cm-gutters cm-gutters-before",this.dom.setAttribute("aria-hidden","true"),this.dom.style.minHeight=this.view.contentHeight/this.view.scaleY+"px",this.gutters=s.state.facet(Ao).map(e=>new dl(s,e)),this.fixed=!s.state.facet(Wu);for(let e of this.gutters)e.config.side=="after"?this.getDOMAfter().appendChild(e.dom):this.dom.appendChild(e.dom);this.fixed&&(this.dom.style.position="sticky"),this.syncGutters(!1),s.scrollDOM.insertBefore(this.dom,s.contentDOM)}getDOMAfter(){return this.domAfter||(this.domAfter=document.createElement("div"),this.domAfter.className="cm-gutters cm-gutters-after",this.domAfter.setAttribute("aria-hidden","true"),this.domAfter.style.minHeight=this.view.contentHeight/this.view.scaleY+"px",this.domAfter.style.position=this.fixed?"sticky":"",this.view.scrollDOM.appendChild(this.domAfter)),this.domAfter}update(s){if(this.updateGutters(s)){let e=this.prevViewport,t=s.view.viewport,i=Math.min(e.to,t.to)-Math.max(e.from,t.from);this.syncGutters(i<(t.to-t.from)*.8)}if(s.geometryChanged){let e=this.view.contentHeight/this.view.scaleY+"px";this.dom.style.minHeight=e,this.domAfter&&(this.domAfter.style.minHeight=e)}this.view.state.facet(Wu)!=!this.fixed&&(this.fixed=!this.fixed,this.dom.style.position=this.fixed?"sticky":"",this.domAfter&&(this.domAfter.style.position=this.fixed?"sticky":"")),this.prevViewport=s.view.viewport}syncGutters(s){let e=this.dom.nextSibling;s&&(this.dom.remove(),this.domAfter&&this.domAfter.remove());let t=Me.iter(this.view.state.facet(jh),this.view.viewport.from),i=[],n=this.gutters.map(r=>new Xu(r,this.view.viewport,-this.view.documentPadding.top));for(let r of this.view.viewportLineBlocks)if(i.length&&(i=[]),Array.isArray(r.type)){let o=!0;for(let a of r.type)if(a.type==Tt.Text&&o){qu(t,i,a.from);for(let l of n)l.line(this.view,a,i);o=!1}else if(a.widget)for(let l of n)l.widget(this.view,a)}else if(r.type==Tt.Text){qu(t,i,r.from);for(let o of n)o.line(this.view,r,i)}else if(r.widget)for(let o of n)o.widget(this.view,r);for(let r of n)r.finish();s&&(this.view.scrollDOM.insertBefore(this.dom,e),this.domAfter&&this.view.scrollDOM.appendChild(this.domAfter))}updateGutters(s){let e=s.startState.facet(Ao),t=s.state.facet(Ao),i=s.docChanged||s.heightChanged||s.viewportChanged||!Me.eq(s.startState.facet(jh),s.state.facet(jh),s.view.viewport.from,s.view.viewport.to);if(e==t)for(let n of this.gutters)n.update(s)&&(i=!0);else{i=!0;let n=[];for(let r of t){let o=e.indexOf(r);o<0?n.push(new dl(this.view,r)):(this.gutters[o].update(s),n.push(this.gutters[o]))}for(let r of this.gutters)r.dom.remove(),n.indexOf(r)<0&&r.destroy();for(let r of n)r.config.side=="after"?this.getDOMAfter().appendChild(r.dom):this.dom.appendChild(r.dom);this.gutters=n}return i}destroy(){for(let s of this.gutters)s.destroy();this.dom.remove(),this.domAfter&&this.domAfter.remove()}},{provide:s=>ee.scrollMargins.of(e=>{let t=e.plugin(s);if(!t||t.gutters.length==0||!t.fixed)return null;let i=t.dom.offsetWidth*e.scaleX,n=t.domAfter?t.domAfter.offsetWidth*e.scaleX:0;return e.textDirection==Ie.LTR?{left:i,right:n}:{right:i,left:n}})});function cg(s){return Array.isArray(s)?s:[s]}function qu(s,e,t){for(;s.value&&s.from<=t;)s.from==t&&e.push(s.value),s.next()}var Xu=class{constructor(e,t,i){this.gutter=e,this.height=i,this.i=0,this.cursor=Me.iter(e.markers,t.from)}addElement(e,t,i){let{gutter:n}=this,r=(t.top-this.height)/e.scaleY,o=t.height/e.scaleY;if(this.i==n.elements.length){let a=new pl(e,o,r,i);n.elements.push(a),n.dom.appendChild(a.dom)}else n.elements[this.i].update(e,o,r,i);this.height=t.bottom,this.i++}line(e,t,i){let n=[];qu(this.cursor,n,t.from),i.length&&(n=n.concat(i));let r=this.gutter.config.lineMarker(e,t,n);r&&n.unshift(r);let o=this.gutter;n.length==0&&!o.config.renderEmptyElements||this.addElement(e,t,n)}widget(e,t){let i=this.gutter.config.widgetMarker(e,t.widget,t),n=i?[i]:null;for(let r of e.state.facet(pw)){let o=r(e,t.widget,t);o&&(n||(n=[])).push(o)}n&&this.addElement(e,t,n)}finish(){let e=this.gutter;for(;e.elements.length>this.i;){let t=e.elements.pop();e.dom.removeChild(t.dom),t.destroy()}}},dl=class{constructor(e,t){this.view=e,this.config=t,this.elements=[],this.spacer=null,this.dom=document.createElement("div"),this.dom.className="cm-gutter"+(this.config.class?" "+this.config.class:"");for(let i in t.domEventHandlers)this.dom.addEventListener(i,n=>{let r=n.target,o;if(r!=this.dom&&this.dom.contains(r)){for(;r.parentNode!=this.dom;)r=r.parentNode;let l=r.getBoundingClientRect();o=(l.top+l.bottom)/2}else o=n.clientY;let a=e.lineBlockAtHeight(o-e.documentTop);t.domEventHandlers[i](e,a,n)&&n.preventDefault()});this.markers=cg(t.markers(e)),t.initialSpacer&&(this.spacer=new pl(e,0,0,[t.initialSpacer(e)]),this.dom.appendChild(this.spacer.dom),this.spacer.dom.style.cssText+="visibility: hidden; pointer-events: none")}update(e){let t=this.markers;if(this.markers=cg(this.config.markers(e.view)),this.spacer&&this.config.updateSpacer){let n=this.config.updateSpacer(this.spacer.markers[0],e);n!=this.spacer.markers[0]&&this.spacer.update(e.view,0,0,[n])}let i=e.view.viewport;return!Me.eq(this.markers,t,i.from,i.to)||(this.config.lineMarkerChange?this.config.lineMarkerChange(e):!1)}destroy(){for(let e of this.elements)e.destroy()}},pl=class{constructor(e,t,i,n){this.height=-1,this.above=0,this.markers=[],this.dom=document.createElement("div"),this.dom.className="cm-gutterElement",this.update(e,t,i,n)}update(e,t,i,n){this.height!=t&&(this.height=t,this.dom.style.height=t+"px"),this.above!=i&&(this.dom.style.marginTop=(this.above=i)?i+"px":""),xw(this.markers,n)||this.setMarkers(e,n)}setMarkers(e,t){let i="cm-gutterElement",n=this.dom.firstChild;for(let r=0,o=0;;){let a=o,l=r<t.length?t[r++]:null,c=!1;if(l){let h=l.elementClass;h&&(i+=" "+h);for(let u=o;u<this.markers.length;u++)if(this.markers[u].compare(l)){a=u,c=!0;break}}else a=this.markers.length;for(;o<a;){let h=this.markers[o++];if(h.toDOM){h.destroy(n);let u=n.nextSibling;n.remove(),n=u}}if(!l)break;l.toDOM&&(c?n=n.nextSibling:this.dom.insertBefore(l.toDOM(e),n)),c&&o++}this.dom.className=i,this.markers=t}destroy(){this.setMarkers(null,[])}};function xw(s,e){if(s.length!=e.length)return!1;for(let t=0;t<s.length;t++)if(!s[t].compare(e[t]))return!1;return!0}var vw=$.define(),yw=$.define(),gr=$.define({combine(s){return vi(s,{formatNumber:String,domEventHandlers:{}},{domEventHandlers(e,t){let i=Object.assign({},e);for(let n in t){let r=i[n],o=t[n];i[n]=r?(a,l,c)=>r(a,l,c)||o(a,l,c):o}return i}})}}),To=class extends wi{constructor(e){super(),this.number=e}eq(e){return this.number==e.number}toDOM(){return document.createTextNode(this.number)}};function Qh(s,e){return s.state.facet(gr).formatNumber(e,s.state)}var bw=Ao.compute([gr],s=>({class:"cm-lineNumbers",renderEmptyElements:!1,markers(e){return e.state.facet(vw)},lineMarker(e,t,i){return i.some(n=>n.toDOM)?null:new To(Qh(e,e.state.doc.lineAt(t.from).number))},widgetMarker:(e,t,i)=>{for(let n of e.state.facet(yw)){let r=n(e,t,i);if(r)return r}return null},lineMarkerChange:e=>e.startState.facet(gr)!=e.state.facet(gr),initialSpacer(e){return new To(Qh(e,hg(e.state.doc.lines)))},updateSpacer(e,t){let i=Qh(t.view,hg(t.view.state.doc.lines));return i==e.number?e:new To(i)},domEventHandlers:s.facet(gr).domEventHandlers,side:"before"}));function _0(s={}){return[gr.of(s),b0(),bw]}function hg(s){let e=9;for(;e<s;)e=e*10+9;return e}var _w=0,Io=class{constructor(e,t){this.from=e,this.to=t}},me=class{constructor(e={}){this.id=_w++,this.perNode=!!e.perNode,this.deserialize=e.deserialize||(()=>{throw new Error("This node type doesn't define a deserialize function")}),this.combine=e.combine||null}add(e){if(this.perNode)throw new RangeError("Can't add per-node props to node types");return typeof e!="function"&&(e=Ht.match(e)),t=>{let i=e(t);return i===void 0?null:[this,i]}}};me.closedBy=new me({deserialize:s=>s.split(" ")});me.openedBy=new me({deserialize:s=>s.split(" ")});me.group=new me({deserialize:s=>s.split(" ")});me.isolate=new me({deserialize:s=>{if(s&&s!="rtl"&&s!="ltr"&&s!="auto")throw new RangeError("Invalid value for isolate: "+s);return s||"auto"}});me.contextHash=new me({perNode:!0});me.lookAhead=new me({perNode:!0});me.mounted=new me({perNode:!0});var _s=class{constructor(e,t,i,n=!1){this.tree=e,this.overlay=t,this.parser=i,this.bracketed=n}static get(e){return e&&e.props&&e.props[me.mounted.id]}},Sw=Object.create(null),Ht=class s{constructor(e,t,i,n=0){this.name=e,this.props=t,this.id=i,this.flags=n}static define(e){let t=e.props&&e.props.length?Object.create(null):Sw,i=(e.top?1:0)|(e.skipped?2:0)|(e.error?4:0)|(e.name==null?8:0),n=new s(e.name||"",t,e.id,i);if(e.props){for(let r of e.props)if(Array.isArray(r)||(r=r(n)),r){if(r[0].perNode)throw new RangeError("Can't store a per-node prop on a node type");t[r[0].id]=r[1]}}return n}prop(e){return this.props[e.id]}get isTop(){return(this.flags&1)>0}get isSkipped(){return(this.flags&2)>0}get isError(){return(this.flags&4)>0}get isAnonymous(){return(this.flags&8)>0}is(e){if(typeof e=="string"){if(this.name==e)return!0;let t=this.prop(me.group);return t?t.indexOf(e)>-1:!1}return this.id==e}static match(e){let t=Object.create(null);for(let i in e)for(let n of i.split(" "))t[n]=e[i];return i=>{for(let n=i.prop(me.group),r=-1;r<(n?n.length:0);r++){let o=t[r<0?i.name:n[r]];if(o)return o}}}};Ht.none=new Ht("",Object.create(null),0,8);var _l=class s{constructor(e){this.types=e;for(let t=0;t<e.length;t++)if(e[t].id!=t)throw new RangeError("Node type ids should correspond to array positions when creating a node set")}extend(...e){let t=[];for(let i of this.types){let n=null;for(let r of e){let o=r(i);if(o){n||(n=Object.assign({},i.props));let a=o[1],l=o[0];l.combine&&l.id in n&&(a=l.combine(n[l.id],a)),n[l.id]=a}}t.push(n?new Ht(i.name,n,i.id,i.flags):i)}return new s(t)}},yl=new WeakMap,S0=new WeakMap,tt;(function(s){s[s.ExcludeBuffers=1]="ExcludeBuffers",s[s.IncludeAnonymous=2]="IncludeAnonymous",s[s.IgnoreMounts=4]="IgnoreMounts",s[s.IgnoreOverlays=8]="IgnoreOverlays",s[s.EnterBracketed=16]="EnterBracketed"})(tt||(tt={}));var Je=class s{constructor(e,t,i,n,r){if(this.type=e,this.children=t,this.positions=i,this.length=n,this.props=null,r&&r.length){this.props=Object.create(null);for(let[o,a]of r)this.props[typeof o=="number"?o:o.id]=a}}toString(){let e=_s.get(this);if(e&&!e.overlay)return e.tree.toString();let t="";for(let i of this.children){let n=i.toString();n&&(t&&(t+=","),t+=n)}return this.type.name?(/\W/.test(this.type.name)&&!this.type.isError?JSON.stringify(this.type.name):this.type.name)+(t.length?"("+t+")":""):t}cursor(e=0){return new Oo(this.topNode,e)}cursorAt(e,t=0,i=0){let n=yl.get(this)||this.topNode,r=new Oo(n);return r.moveTo(e,t),yl.set(this,r._tree),r}get topNode(){return new on(this,0,0,null)}resolve(e,t=0){let i=Do(yl.get(this)||this.topNode,e,t,!1);return yl.set(this,i),i}resolveInner(e,t=0){let i=Do(S0.get(this)||this.topNode,e,t,!0);return S0.set(this,i),i}resolveStack(e,t=0){return ww(this,e,t)}iterate(e){let{enter:t,leave:i,from:n=0,to:r=this.length}=e,o=e.mode||0,a=(o&tt.IncludeAnonymous)>0;for(let l=this.cursor(o|tt.IncludeAnonymous);;){let c=!1;if(l.from<=r&&l.to>=n&&(!a&&l.type.isAnonymous||t(l)!==!1)){if(l.firstChild())continue;c=!0}for(;c&&i&&(a||!l.type.isAnonymous)&&i(l),!l.nextSibling();){if(!l.parent())return;c=!0}}}prop(e){return e.perNode?this.props?this.props[e.id]:void 0:this.type.prop(e)}get propValues(){let e=[];if(this.props)for(let t in this.props)e.push([+t,this.props[t]]);return e}balance(e={}){return this.children.length<=8?this:uf(Ht.none,this.children,this.positions,0,this.children.length,0,this.length,(t,i,n)=>new s(this.type,t,i,n,this.propValues),e.makeTree||((t,i,n)=>new s(Ht.none,t,i,n)))}static build(e){return Mw(e)}};Je.empty=new Je(Ht.none,[],[],0);var rf=class s{constructor(e,t){this.buffer=e,this.index=t}get id(){return this.buffer[this.index-4]}get start(){return this.buffer[this.index-3]}get end(){return this.buffer[this.index-2]}get size(){return this.buffer[this.index-1]}get pos(){return this.index}next(){this.index-=4}fork(){return new s(this.buffer,this.index)}},Un=class s{constructor(e,t,i){this.buffer=e,this.length=t,this.set=i}get type(){return Ht.none}toString(){let e=[];for(let t=0;t<this.buffer.length;)e.push(this.childString(t)),t=this.buffer[t+3];return e.join(",")}childString(e){let t=this.buffer[e],i=this.buffer[e+3],n=this.set.types[t],r=n.name;if(/\W/.test(r)&&!n.isError&&(r=JSON.stringify(r)),e+=4,i==e)return r;let o=[];for(;e<i;)o.push(this.childString(e)),e=this.buffer[e+3];return r+"("+o.join(",")+")"}findChild(e,t,i,n,r){let{buffer:o}=this,a=-1;for(let l=e;l!=t&&!(A0(r,n,o[l+1],o[l+2])&&(a=l,i>0));l=o[l+3]);return a}slice(e,t,i){let n=this.buffer,r=new Uint16Array(t-e),o=0;for(let a=e,l=0;a<t;){r[l++]=n[a++],r[l++]=n[a++]-i;let c=r[l++]=n[a++]-i;r[l++]=n[a++]-e,o=Math.max(o,c)}return new s(r,o,this.set)}};function A0(s,e,t,i){switch(s){case-2:return t<e;case-1:return i>=e&&t<e;case 0:return t<e&&i>e;case 1:return t<=e&&i>e;case 2:return i>e;case 4:return!0}}function Do(s,e,t,i){for(var n;s.from==s.to||(t<1?s.from>=e:s.from>e)||(t>-1?s.to<=e:s.to<e);){let o=!i&&s instanceof on&&s.index<0?null:s.parent;if(!o)return s;s=o}let r=i?0:tt.IgnoreOverlays;if(i)for(let o=s,a=o.parent;a;o=a,a=o.parent)o instanceof on&&o.index<0&&((n=a.enter(e,t,r))===null||n===void 0?void 0:n.from)!=o.from&&(s=a);for(;;){let o=s.enter(e,t,r);if(!o)return s;s=o}}var Sl=class{cursor(e=0){return new Oo(this,e)}getChild(e,t=null,i=null){let n=w0(this,e,t,i);return n.length?n[0]:null}getChildren(e,t=null,i=null){return w0(this,e,t,i)}resolve(e,t=0){return Do(this,e,t,!1)}resolveInner(e,t=0){return Do(this,e,t,!0)}matchContext(e){return of(this.parent,e)}enterUnfinishedNodesBefore(e){let t=this.childBefore(e),i=this;for(;t;){let n=t.lastChild;if(!n||n.to!=t.to)break;n.type.isError&&n.from==n.to?(i=t,t=n.prevSibling):t=n}return i}get node(){return this}get next(){return this.parent}},on=class s extends Sl{constructor(e,t,i,n){super(),this._tree=e,this.from=t,this.index=i,this._parent=n}get type(){return this._tree.type}get name(){return this._tree.type.name}get to(){return this.from+this._tree.length}nextChild(e,t,i,n,r=0){for(let o=this;;){for(let{children:a,positions:l}=o._tree,c=t>0?a.length:-1;e!=c;e+=t){let h=a[e],u=l[e]+o.from,f;if(!(!(r&tt.EnterBracketed&&h instanceof Je&&(f=_s.get(h))&&!f.overlay&&f.bracketed&&i>=u&&i<=u+h.length)&&!A0(n,i,u,u+h.length))){if(h instanceof Un){if(r&tt.ExcludeBuffers)continue;let d=h.findChild(0,h.buffer.length,t,i-u,n);if(d>-1)return new No(new af(o,h,e,u),null,d)}else if(r&tt.IncludeAnonymous||!h.type.isAnonymous||hf(h)){let d;if(!(r&tt.IgnoreMounts)&&(d=_s.get(h))&&!d.overlay)return new s(d.tree,u,e,o);let m=new s(h,u,e,o);return r&tt.IncludeAnonymous||!m.type.isAnonymous?m:m.nextChild(t<0?h.children.length-1:0,t,i,n,r)}}}if(r&tt.IncludeAnonymous||!o.type.isAnonymous||(o.index>=0?e=o.index+t:e=t<0?-1:o._parent._tree.children.length,o=o._parent,!o))return null}}get firstChild(){return this.nextChild(0,1,0,4)}get lastChild(){return this.nextChild(this._tree.children.length-1,-1,0,4)}childAfter(e){return this.nextChild(0,1,e,2)}childBefore(e){return this.nextChild(this._tree.children.length-1,-1,e,-2)}prop(e){return this._tree.prop(e)}enter(e,t,i=0){let n;if(!(i&tt.IgnoreOverlays)&&(n=_s.get(this._tree))&&n.overlay){let r=e-this.from,o=i&tt.EnterBracketed&&n.bracketed;for(let{from:a,to:l}of n.overlay)if((t>0||o?a<=r:a<r)&&(t<0||o?l>=r:l>r))return new s(n.tree,n.overlay[0].from+this.from,-1,this)}return this.nextChild(0,1,e,t,i)}nextSignificantParent(){let e=this;for(;e.type.isAnonymous&&e._parent;)e=e._parent;return e}get parent(){return this._parent?this._parent.nextSignificantParent():null}get nextSibling(){return this._parent&&this.index>=0?this._parent.nextChild(this.index+1,1,0,4):null}get prevSibling(){return this._parent&&this.index>=0?this._parent.nextChild(this.index-1,-1,0,4):null}get tree(){return this._tree}toTree(){return this._tree}toString(){return this._tree.toString()}};function w0(s,e,t,i){let n=s.cursor(),r=[];if(!n.firstChild())return r;if(t!=null){for(let o=!1;!o;)if(o=n.type.is(t),!n.nextSibling())return r}for(;;){if(i!=null&&n.type.is(i))return r;if(n.type.is(e)&&r.push(n.node),!n.nextSibling())return i==null?r:[]}}function of(s,e,t=e.length-1){for(let i=s;t>=0;i=i.parent){if(!i)return!1;if(!i.type.isAnonymous){if(e[t]&&e[t]!=i.name)return!1;t--}}return!0}var af=class{constructor(e,t,i,n){this.parent=e,this.buffer=t,this.index=i,this.start=n}},No=class s extends Sl{get name(){return this.type.name}get from(){return this.context.start+this.context.buffer.buffer[this.index+1]}get to(){return this.context.start+this.context.buffer.buffer[this.index+2]}constructor(e,t,i){super(),this.context=e,this._parent=t,this.index=i,this.type=e.buffer.set.types[e.buffer.buffer[i]]}child(e,t,i){let{buffer:n}=this.context,r=n.findChild(this.index+4,n.buffer[this.index+3],e,t-this.context.start,i);return r<0?null:new s(this.context,this,r)}get firstChild(){return this.child(1,0,4)}get lastChild(){return this.child(-1,0,4)}childAfter(e){return this.child(1,e,2)}childBefore(e){return this.child(-1,e,-2)}prop(e){return this.type.prop(e)}enter(e,t,i=0){if(i&tt.ExcludeBuffers)return null;let{buffer:n}=this.context,r=n.findChild(this.index+4,n.buffer[this.index+3],t>0?1:-1,e-this.context.start,t);return r<0?null:new s(this.context,this,r)}get parent(){return this._parent||this.context.parent.nextSignificantParent()}externalSibling(e){return this._parent?null:this.context.parent.nextChild(this.context.index+e,e,0,4)}get nextSibling(){let{buffer:e}=this.context,t=e.buffer[this.index+3];return t<(this._parent?e.buffer[this._parent.index+3]:e.buffer.length)?new s(this.context,this._parent,t):this.externalSibling(1)}get prevSibling(){let{buffer:e}=this.context,t=this._parent?this._parent.index+4:0;return this.index==t?this.externalSibling(-1):new s(this.context,this._parent,e.findChild(t,this.index,-1,0,4))}get tree(){return null}toTree(){let e=[],t=[],{buffer:i}=this.context,n=this.index+4,r=i.buffer[this.index+3];if(r>n){let o=i.buffer[this.index+1];e.push(i.slice(n,r,o)),t.push(0)}return new Je(this.type,e,t,this.to-this.from)}toString(){return this.context.buffer.childString(this.index)}};function T0(s){if(!s.length)return null;let e=0,t=s[0];for(let r=1;r<s.length;r++){let o=s[r];(o.from>t.from||o.to<t.to)&&(t=o,e=r)}let i=t instanceof on&&t.index<0?null:t.parent,n=s.slice();return i?n[e]=i:n.splice(e,1),new lf(n,t)}var lf=class{constructor(e,t){this.heads=e,this.node=t}get next(){return T0(this.heads)}};function ww(s,e,t){let i=s.resolveInner(e,t),n=null;for(let r=i instanceof on?i:i.context.parent;r;r=r.parent)if(r.index<0){let o=r.parent;(n||(n=[i])).push(o.resolve(e,t)),r=o}else{let o=_s.get(r.tree);if(o&&o.overlay&&o.overlay[0].from<=e&&o.overlay[o.overlay.length-1].to>=e){let a=new on(o.tree,o.overlay[0].from+r.from,-1,r);(n||(n=[i])).push(Do(a,e,t,!1))}}return n?T0(n):i}var Oo=class{get name(){return this.type.name}constructor(e,t=0){if(this.buffer=null,this.stack=[],this.index=0,this.bufferNode=null,this.mode=t&~tt.EnterBracketed,e instanceof on)this.yieldNode(e);else{this._tree=e.context.parent,this.buffer=e.context;for(let i=e._parent;i;i=i._parent)this.stack.unshift(i.index);this.bufferNode=e,this.yieldBuf(e.index)}}yieldNode(e){return e?(this._tree=e,this.type=e.type,this.from=e.from,this.to=e.to,!0):!1}yieldBuf(e,t){this.index=e;let{start:i,buffer:n}=this.buffer;return this.type=t||n.set.types[n.buffer[e]],this.from=i+n.buffer[e+1],this.to=i+n.buffer[e+2],!0}yield(e){return e?e instanceof on?(this.buffer=null,this.yieldNode(e)):(this.buffer=e.context,this.yieldBuf(e.index,e.type)):!1}toString(){return this.buffer?this.buffer.buffer.childString(this.index):this._tree.toString()}enterChild(e,t,i){if(!this.buffer)return this.yield(this._tree.nextChild(e<0?this._tree._tree.children.length-1:0,e,t,i,this.mode));let{buffer:n}=this.buffer,r=n.findChild(this.index+4,n.buffer[this.index+3],e,t-this.buffer.start,i);return r<0?!1:(this.stack.push(this.index),this.yieldBuf(r))}firstChild(){return this.enterChild(1,0,4)}lastChild(){return this.enterChild(-1,0,4)}childAfter(e){return this.enterChild(1,e,2)}childBefore(e){return this.enterChild(-1,e,-2)}enter(e,t,i=this.mode){return this.buffer?i&tt.ExcludeBuffers?!1:this.enterChild(1,e,t):this.yield(this._tree.enter(e,t,i))}parent(){if(!this.buffer)return this.yieldNode(this.mode&tt.IncludeAnonymous?this._tree._parent:this._tree.parent);if(this.stack.length)return this.yieldBuf(this.stack.pop());let e=this.mode&tt.IncludeAnonymous?this.buffer.parent:this.buffer.parent.nextSignificantParent();return this.buffer=null,this.yieldNode(e)}sibling(e){if(!this.buffer)return this._tree._parent?this.yield(this._tree.index<0?null:this._tree._parent.nextChild(this._tree.index+e,e,0,4,this.mode)):!1;let{buffer:t}=this.buffer,i=this.stack.length-1;if(e<0){let n=i<0?0:this.stack[i]+4;if(this.index!=n)return this.yieldBuf(t.findChild(n,this.index,-1,0,4))}else{let n=t.buffer[this.index+3];if(n<(i<0?t.buffer.length:t.buffer[this.stack[i]+3]))return this.yieldBuf(n)}return i<0?this.yield(this.buffer.parent.nextChild(this.buffer.index+e,e,0,4,this.mode)):!1}nextSibling(){return this.sibling(1)}prevSibling(){return this.sibling(-1)}atLastNode(e){let t,i,{buffer:n}=this;if(n){if(e>0){if(this.index<n.buffer.buffer.length)return!1}else for(let r=0;r<this.index;r++)if(n.buffer.buffer[r+3]<this.index)return!1;({index:t,parent:i}=n)}else({index:t,_parent:i}=this._tree);for(;i;{index:t,_parent:i}=i)if(t>-1)for(let r=t+e,o=e<0?-1:i._tree.children.length;r!=o;r+=e){let a=i._tree.children[r];if(this.mode&tt.IncludeAnonymous||a instanceof Un||!a.type.isAnonymous||hf(a))return!1}return!0}move(e,t){if(t&&this.enterChild(e,0,4))return!0;for(;;){if(this.sibling(e))return!0;if(this.atLastNode(e)||!this.parent())return!1}}next(e=!0){return this.move(1,e)}prev(e=!0){return this.move(-1,e)}moveTo(e,t=0){for(;(this.from==this.to||(t<1?this.from>=e:this.from>e)||(t>-1?this.to<=e:this.to<e))&&this.parent(););for(;this.enterChild(1,e,t););return this}get node(){if(!this.buffer)return this._tree;let e=this.bufferNode,t=null,i=0;if(e&&e.context==this.buffer)e:for(let n=this.index,r=this.stack.length;r>=0;){for(let o=e;o;o=o._parent)if(o.index==n){if(n==this.index)return o;t=o,i=r+1;break e}n=this.stack[--r]}for(let n=i;n<this.stack.length;n++)t=new No(this.buffer,t,this.stack[n]);return this.bufferNode=new No(this.buffer,t,this.index)}get tree(){return this.buffer?null:this._tree._tree}iterate(e,t){for(let i=0;;){let n=!1;if(this.type.isAnonymous||e(this)!==!1){if(this.firstChild()){i++;continue}this.type.isAnonymous||(n=!0)}for(;;){if(n&&t&&t(this),n=this.type.isAnonymous,!i)return;if(this.nextSibling())break;this.parent(),i--,n=!0}}}matchContext(e){if(!this.buffer)return of(this.node.parent,e);let{buffer:t}=this.buffer,{types:i}=t.set;for(let n=e.length-1,r=this.stack.length-1;n>=0;r--){if(r<0)return of(this._tree,e,n);let o=i[t.buffer[this.stack[r]]];if(!o.isAnonymous){if(e[n]&&e[n]!=o.name)return!1;n--}}return!0}};function hf(s){return s.children.some(e=>e instanceof Un||!e.type.isAnonymous||hf(e))}function Mw(s){var e;let{buffer:t,nodeSet:i,maxBufferLength:n=1024,reused:r=[],minRepeatType:o=i.types.length}=s,a=Array.isArray(t)?new rf(t,t.length):t,l=i.types,c=0,h=0;function u(C,E,P,O,H,G){let{id:k,start:D,end:F,size:V}=a,N=h,ie=c;if(V<0)if(a.next(),V==-1){let ue=r[k];P.push(ue),O.push(D-C);return}else if(V==-3){c=k;return}else if(V==-4){h=k;return}else throw new RangeError(`Unrecognized record size: ${V}`);let X=l[k],Pe,ce,ae=D-C;if(F-D<=n&&(ce=y(a.pos-E,H))){let ue=new Uint16Array(ce.size-ce.skip),se=a.pos-ce.size,j=ue.length;for(;a.pos>se;)j=_(ce.start,ue,j);Pe=new Un(ue,F-ce.start,i),ae=ce.start-C}else{let ue=a.pos-V;a.next();let se=[],j=[],ke=k>=o?k:-1,Ve=0,Ee=F,xe=N;for(;a.pos>ue;)ke>=0&&a.id==ke&&a.size>=0?(a.end<=Ee-n&&(m(se,j,D,Ve,a.end,Ee,ke,xe,ie),Ve=se.length,Ee=a.end,xe=h),a.next()):G>2500?f(D,ue,se,j):(ke>=0&&a.size==-1&&r[a.id].type==i.types[ke]&&(Ve<se.length&&m(se,j,D,Ve,a.end,Ee,ke,xe,ie),Ve=se.length+1,Ee=a.start,xe=h),u(D,ue,se,j,ke,G+1));if(ke>=0&&Ve>0&&Ve<se.length&&m(se,j,D,Ve,D,Ee,ke,xe,ie),se.reverse(),j.reverse(),ke>-1&&Ve>0){let qt=d(X,ie);Pe=uf(X,se,j,0,se.length,0,F-D,qt,qt)}else Pe=g(X,se,j,F-D,N-F,ie)}P.push(Pe),O.push(ae)}function f(C,E,P,O){let H=[],G=0,k=-1;for(;a.pos>E;){let{id:D,start:F,end:V,size:N}=a;if(N>4)a.next();else{if(k>-1&&F<k)break;k<0&&(k=V-n),H.push(D,F,V),G++,a.next()}}if(G){let D=new Uint16Array(G*4),F=H[H.length-2];for(let V=H.length-3,N=0;V>=0;V-=3)D[N++]=H[V],D[N++]=H[V+1]-F,D[N++]=H[V+2]-F,D[N++]=N;P.push(new Un(D,H[2]-F,i)),O.push(F-C)}}function d(C,E){return(P,O,H)=>{let G=0,k=P.length-1,D,F;if(k>=0&&(D=P[k])instanceof Je){if(!k&&D.type==C&&D.length==H)return D;(F=D.prop(me.lookAhead))&&(G=O[k]+D.length+F-H)}return g(C,P,O,H,G,E)}}function m(C,E,P,O,H,G,k,D,F){let V=[],N=[];for(;C.length>O;)V.push(C.pop()),N.push(E.pop()+P-H);C.push(g(i.types[k],V,N,G-H,D-G,F)),E.push(H-P)}function g(C,E,P,O,H,G,k){if(G){let D=[me.contextHash,G];k=k?[D].concat(k):[D]}if(H>25){let D=[me.lookAhead,H];k=k?[D].concat(k):[D]}return new Je(C,E,P,O,k)}function y(C,E){let P=a.fork(),O=0,H=0,G=0,k=P.end-n,D={size:0,start:0,skip:0};e:for(let F=P.pos-C;P.pos>F;){let V=P.size;if(P.id==E&&V>=0){D.size=O,D.start=H,D.skip=G,G+=4,O+=4,P.next();continue}let N=P.pos-V;if(V<0||N<F||P.start<k)break;let ie=P.id>=o?4:0,X=P.start;for(P.next();P.pos>N;){if(P.size<0)if(P.size==-3||P.size==-4)ie+=4;else break e;else P.id>=o&&(ie+=4);P.next()}H=X,O+=V,G+=ie}return(E<0||O==C)&&(D.size=O,D.start=H,D.skip=G),D.size>4?D:void 0}function _(C,E,P){let{id:O,start:H,end:G,size:k}=a;if(a.next(),k>=0&&O<o){let D=P;if(k>4){let F=a.pos-(k-4);for(;a.pos>F;)P=_(C,E,P)}E[--P]=D,E[--P]=G-C,E[--P]=H-C,E[--P]=O}else k==-3?c=O:k==-4&&(h=O);return P}let w=[],A=[];for(;a.pos>0;)u(s.start||0,s.bufferStart||0,w,A,-1,0);let T=(e=s.length)!==null&&e!==void 0?e:w.length?A[0]+w[0].length:0;return new Je(l[s.topID],w.reverse(),A.reverse(),T)}var M0=new WeakMap;function bl(s,e){if(!s.isAnonymous||e instanceof Un||e.type!=s)return 1;let t=M0.get(e);if(t==null){t=1;for(let i of e.children){if(i.type!=s||!(i instanceof Je)){t=1;break}t+=bl(s,i)}M0.set(e,t)}return t}function uf(s,e,t,i,n,r,o,a,l){let c=0;for(let m=i;m<n;m++)c+=bl(s,e[m]);let h=Math.ceil(c*1.5/8),u=[],f=[];function d(m,g,y,_,w){for(let A=y;A<_;){let T=A,C=g[A],E=bl(s,m[A]);for(A++;A<_;A++){let P=bl(s,m[A]);if(E+P>=h)break;E+=P}if(A==T+1){if(E>h){let P=m[T];d(P.children,P.positions,0,P.children.length,g[T]+w);continue}u.push(m[T])}else{let P=g[A-1]+m[A-1].length-C;u.push(uf(s,m,g,T,A,C,P,null,l))}f.push(C+w-r)}}return d(e,t,i,n,0),(a||l)(u,f,o)}var Ss=class s{constructor(e,t,i,n,r=!1,o=!1){this.from=e,this.to=t,this.tree=i,this.offset=n,this.open=(r?1:0)|(o?2:0)}get openStart(){return(this.open&1)>0}get openEnd(){return(this.open&2)>0}static addTree(e,t=[],i=!1){let n=[new s(0,e.length,e,0,!1,i)];for(let r of t)r.to>e.length&&n.push(r);return n}static applyChanges(e,t,i=128){if(!t.length)return e;let n=[],r=1,o=e.length?e[0]:null;for(let a=0,l=0,c=0;;a++){let h=a<t.length?t[a]:null,u=h?h.fromA:1e9;if(u-l>=i)for(;o&&o.from<u;){let f=o;if(l>=f.from||u<=f.to||c){let d=Math.max(f.from,l)-c,m=Math.min(f.to,u)-c;f=d>=m?null:new s(d,m,f.tree,f.offset+c,a>0,!!h)}if(f&&n.push(f),o.to>u)break;o=r<e.length?e[r++]:null}if(!h)break;l=h.toA,c=h.toA-h.toB}return n}},Fo=class{startParse(e,t,i){return typeof e=="string"&&(e=new cf(e)),i=i?i.length?i.map(n=>new Io(n.from,n.to)):[new Io(0,0)]:[new Io(0,e.length)],this.createParse(e,t||[],i)}parse(e,t,i){let n=this.startParse(e,t,i);for(;;){let r=n.advance();if(r)return r}}},cf=class{constructor(e){this.string=e}get length(){return this.string.length}chunk(e){return this.string.slice(e)}get lineChunks(){return!1}read(e,t){return this.string.slice(e,t)}};var r2=new me({perNode:!0});var Aw=0,Bi=class s{constructor(e,t,i,n){this.name=e,this.set=t,this.base=i,this.modified=n,this.id=Aw++}toString(){let{name:e}=this;for(let t of this.modified)t.name&&(e=`${t.name}(${e})`);return e}static define(e,t){let i=typeof e=="string"?e:"?";if(e instanceof s&&(t=e),t?.base)throw new Error("Can not derive from a modified tag");let n=new s(i,[],null,[]);if(n.set.push(n),t)for(let r of t.set)n.set.push(r);return n}static defineModifier(e){let t=new Tl(e);return i=>i.modified.indexOf(t)>-1?i:Tl.get(i.base||i,i.modified.concat(t).sort((n,r)=>n.id-r.id))}},Tw=0,Tl=class s{constructor(e){this.name=e,this.instances=[],this.id=Tw++}static get(e,t){if(!t.length)return e;let i=t[0].instances.find(a=>a.base==e&&Ew(t,a.modified));if(i)return i;let n=[],r=new Bi(e.name,n,e,t);for(let a of t)a.instances.push(r);let o=Cw(t);for(let a of e.set)if(!a.modified.length)for(let l of o)n.push(s.get(a,l));return r}};function Ew(s,e){return s.length==e.length&&s.every((t,i)=>t==e[i])}function Cw(s){let e=[[]];for(let t=0;t<s.length;t++)for(let i=0,n=e.length;i<n;i++)e.push(e[i].concat(s[t]));return e.sort((t,i)=>i.length-t.length)}function R0(s){let e=Object.create(null);for(let t in s){let i=s[t];Array.isArray(i)||(i=[i]);for(let n of t.split(" "))if(n){let r=[],o=2,a=n;for(let u=0;;){if(a=="..."&&u>0&&u+3==n.length){o=1;break}let f=/^"(?:[^"\\]|\\.)*?"|[^\/!]+/.exec(a);if(!f)throw new RangeError("Invalid path: "+n);if(r.push(f[0]=="*"?"":f[0][0]=='"'?JSON.parse(f[0]):f[0]),u+=f[0].length,u==n.length)break;let d=n[u++];if(u==n.length&&d=="!"){o=0;break}if(d!="/")throw new RangeError("Invalid path: "+n);a=n.slice(u)}let l=r.length-1,c=r[l];if(!c)throw new RangeError("Invalid path: "+n);let h=new Ms(i,o,l>0?r.slice(0,l):null);e[c]=h.sort(e[c])}}return P0.add(e)}var P0=new me({combine(s,e){let t,i,n;for(;s||e;){if(!s||e&&s.depth<=e.depth?(n=e,e=e.next):(n=s,s=s.next),t&&t.mode==n.mode&&!n.context&&!t.context)continue;let r=new Ms(n.tags,n.mode,n.context);t?t.next=r:i=r,t=r}return i}}),Ms=class{constructor(e,t,i,n){this.tags=e,this.mode=t,this.context=i,this.next=n}get opaque(){return this.mode==0}get inherit(){return this.mode==1}sort(e){return!e||e.depth<this.depth?(this.next=e,this):(e.next=this.sort(e.next),e)}get depth(){return this.context?this.context.length:0}};Ms.empty=new Ms([],2,null);function mf(s,e){let t=Object.create(null);for(let r of s)if(!Array.isArray(r.tag))t[r.tag.id]=r.class;else for(let o of r.tag)t[o.id]=r.class;let{scope:i,all:n=null}=e||{};return{style:r=>{let o=n;for(let a of r)for(let l of a.set){let c=t[l.id];if(c){o=o?o+" "+c:c;break}}return o},scope:i}}function Rw(s,e){let t=null;for(let i of s){let n=i.style(e);n&&(t=t?t+" "+n:n)}return t}function k0(s,e,t,i=0,n=s.length){let r=new df(i,Array.isArray(e)?e:[e],t);r.highlightRange(s.cursor(),i,n,"",r.highlighters),r.flush(n)}var df=class{constructor(e,t,i){this.at=e,this.highlighters=t,this.span=i,this.class=""}startSpan(e,t){t!=this.class&&(this.flush(e),e>this.at&&(this.at=e),this.class=t)}flush(e){e>this.at&&this.class&&this.span(this.at,e,this.class)}highlightRange(e,t,i,n,r){let{type:o,from:a,to:l}=e;if(a>=i||l<=t)return;o.isTop&&(r=this.highlighters.filter(d=>!d.scope||d.scope(o)));let c=n,h=Pw(e)||Ms.empty,u=Rw(r,h.tags);if(u&&(c&&(c+=" "),c+=u,h.mode==1&&(n+=(n?" ":"")+u)),this.startSpan(Math.max(t,a),c),h.opaque)return;let f=e.tree&&e.tree.prop(me.mounted);if(f&&f.overlay){let d=e.node.enter(f.overlay[0].from+a,1),m=this.highlighters.filter(y=>!y.scope||y.scope(f.tree.type)),g=e.firstChild();for(let y=0,_=a;;y++){let w=y<f.overlay.length?f.overlay[y]:null,A=w?w.from+a:l,T=Math.max(t,_),C=Math.min(i,A);if(T<C&&g)for(;e.from<C&&(this.highlightRange(e,T,C,n,r),this.startSpan(Math.min(C,e.to),c),!(e.to>=A||!e.nextSibling())););if(!w||A>i)break;_=w.to+a,_>t&&(this.highlightRange(d.cursor(),Math.max(t,w.from+a),Math.min(i,_),"",m),this.startSpan(Math.min(i,_),c))}g&&e.parent()}else if(e.firstChild()){f&&(n="");do if(!(e.to<=t)){if(e.from>=i)break;this.highlightRange(e,t,i,n,r),this.startSpan(Math.min(i,e.to),c)}while(e.nextSibling());e.parent()}}};function Pw(s){let e=s.type.prop(P0);for(;e&&e.context&&!s.matchContext(e.context);)e=e.next;return e||null}var W=Bi.define,wl=W(),zn=W(),E0=W(zn),C0=W(zn),Vn=W(),Ml=W(Vn),ff=W(Vn),cn=W(),ws=W(cn),an=W(),ln=W(),pf=W(),Bo=W(pf),Al=W(),z={comment:wl,lineComment:W(wl),blockComment:W(wl),docComment:W(wl),name:zn,variableName:W(zn),typeName:E0,tagName:W(E0),propertyName:C0,attributeName:W(C0),className:W(zn),labelName:W(zn),namespace:W(zn),macroName:W(zn),literal:Vn,string:Ml,docString:W(Ml),character:W(Ml),attributeValue:W(Ml),number:ff,integer:W(ff),float:W(ff),bool:W(Vn),regexp:W(Vn),escape:W(Vn),color:W(Vn),url:W(Vn),keyword:an,self:W(an),null:W(an),atom:W(an),unit:W(an),modifier:W(an),operatorKeyword:W(an),controlKeyword:W(an),definitionKeyword:W(an),moduleKeyword:W(an),operator:ln,derefOperator:W(ln),arithmeticOperator:W(ln),logicOperator:W(ln),bitwiseOperator:W(ln),compareOperator:W(ln),updateOperator:W(ln),definitionOperator:W(ln),typeOperator:W(ln),controlOperator:W(ln),punctuation:pf,separator:W(pf),bracket:Bo,angleBracket:W(Bo),squareBracket:W(Bo),paren:W(Bo),brace:W(Bo),content:cn,heading:ws,heading1:W(ws),heading2:W(ws),heading3:W(ws),heading4:W(ws),heading5:W(ws),heading6:W(ws),contentSeparator:W(cn),list:W(cn),quote:W(cn),emphasis:W(cn),strong:W(cn),link:W(cn),monospace:W(cn),strikethrough:W(cn),inserted:W(),deleted:W(),changed:W(),invalid:W(),meta:Al,documentMeta:W(Al),annotation:W(Al),processingInstruction:W(Al),definition:Bi.defineModifier("definition"),constant:Bi.defineModifier("constant"),function:Bi.defineModifier("function"),standard:Bi.defineModifier("standard"),local:Bi.defineModifier("local"),special:Bi.defineModifier("special")};for(let s in z){let e=z[s];e instanceof Bi&&(e.name=s)}var l2=mf([{tag:z.link,class:"tok-link"},{tag:z.heading,class:"tok-heading"},{tag:z.emphasis,class:"tok-emphasis"},{tag:z.strong,class:"tok-strong"},{tag:z.keyword,class:"tok-keyword"},{tag:z.atom,class:"tok-atom"},{tag:z.bool,class:"tok-bool"},{tag:z.url,class:"tok-url"},{tag:z.labelName,class:"tok-labelName"},{tag:z.inserted,class:"tok-inserted"},{tag:z.deleted,class:"tok-deleted"},{tag:z.literal,class:"tok-literal"},{tag:z.string,class:"tok-string"},{tag:z.number,class:"tok-number"},{tag:[z.regexp,z.escape,z.special(z.string)],class:"tok-string2"},{tag:z.variableName,class:"tok-variableName"},{tag:z.local(z.variableName),class:"tok-variableName tok-local"},{tag:z.definition(z.variableName),class:"tok-variableName tok-definition"},{tag:z.special(z.variableName),class:"tok-variableName2"},{tag:z.definition(z.propertyName),class:"tok-propertyName tok-definition"},{tag:z.typeName,class:"tok-typeName"},{tag:z.namespace,class:"tok-namespace"},{tag:z.className,class:"tok-className"},{tag:z.macroName,class:"tok-macroName"},{tag:z.propertyName,class:"tok-propertyName"},{tag:z.operator,class:"tok-operator"},{tag:z.comment,class:"tok-comment"},{tag:z.meta,class:"tok-meta"},{tag:z.invalid,class:"tok-invalid"},{tag:z.punctuation,class:"tok-punctuation"}]);function L0(s,e,t,i=0,n=0){e==null&&(e=s.search(/[^\s\u00a0]/),e==-1&&(e=s.length));let r=n;for(let o=i;o<e;o++)s.charCodeAt(o)==9?r+=t-r%t:r++;return r}var Uo=class{constructor(e,t,i,n){this.string=e,this.tabSize=t,this.indentUnit=i,this.overrideIndent=n,this.pos=0,this.start=0,this.lastColumnPos=0,this.lastColumnValue=0}eol(){return this.pos>=this.string.length}sol(){return this.pos==0}peek(){return this.string.charAt(this.pos)||void 0}next(){if(this.pos<this.string.length)return this.string.charAt(this.pos++)}eat(e){let t=this.string.charAt(this.pos),i;if(typeof e=="string"?i=t==e:i=t&&(e instanceof RegExp?e.test(t):e(t)),i)return++this.pos,t}eatWhile(e){let t=this.pos;for(;this.eat(e););return this.pos>t}eatSpace(){let e=this.pos;for(;/[\s\u00a0]/.test(this.string.charAt(this.pos));)++this.pos;return this.pos>e}skipToEnd(){this.pos=this.string.length}skipTo(e){let t=this.string.indexOf(e,this.pos);if(t>-1)return this.pos=t,!0}backUp(e){this.pos-=e}column(){return this.lastColumnPos<this.start&&(this.lastColumnValue=L0(this.string,this.start,this.tabSize,this.lastColumnPos,this.lastColumnValue),this.lastColumnPos=this.start),this.lastColumnValue}indentation(){var e;return(e=this.overrideIndent)!==null&&e!==void 0?e:L0(this.string,null,this.tabSize)}match(e,t,i){if(typeof e=="string"){let n=o=>i?o.toLowerCase():o,r=this.string.substr(this.pos,e.length);return n(r)==n(e)?(t!==!1&&(this.pos+=e.length),!0):null}else{let n=this.string.slice(this.pos).match(e);return n&&n.index>0?null:(n&&t!==!1&&(this.pos+=n[0].length),n)}}current(){return this.string.slice(this.start,this.pos)}};var gf,Er=new me;function kw(s){return $.define({combine:s?e=>e.concat(s):void 0})}var Lw=new me,si=class{constructor(e,t,i=[],n=""){this.data=e,this.name=n,Ue.prototype.hasOwnProperty("tree")||Object.defineProperty(Ue.prototype,"tree",{get(){return zi(this)}}),this.parser=t,this.extension=[Cr.of(this),Ue.languageData.of((r,o,a)=>{let l=I0(r,o,a),c=l.type.prop(Er);if(!c)return[];let h=r.facet(c),u=l.type.prop(Lw);if(u){let f=l.resolve(o-l.from,a);for(let d of u)if(d.test(f,r)){let m=r.facet(d.facet);return d.type=="replace"?m:m.concat(h)}}return h})].concat(i)}isActiveAt(e,t,i=-1){return I0(e,t,i).type.prop(Er)==this.data}findRegions(e){let t=e.facet(Cr);if(t?.data==this.data)return[{from:0,to:e.doc.length}];if(!t||!t.allowsNesting)return[];let i=[],n=(r,o)=>{if(r.prop(Er)==this.data){i.push({from:o,to:o+r.length});return}let a=r.prop(me.mounted);if(a){if(a.tree.prop(Er)==this.data){if(a.overlay)for(let l of a.overlay)i.push({from:l.from+o,to:l.to+o});else i.push({from:o,to:o+r.length});return}else if(a.overlay){let l=i.length;if(n(a.tree,a.overlay[0].from+o),i.length>l)return}}for(let l=0;l<r.children.length;l++){let c=r.children[l];c instanceof Je&&n(c,r.positions[l]+o)}};return n(zi(e),0),i}get allowsNesting(){return!0}};si.setState=de.define();function I0(s,e,t){let i=s.facet(Cr),n=zi(s).topNode;if(!i||i.allowsNesting)for(let r=n;r;r=r.enter(e,t,tt.ExcludeBuffers|tt.EnterBracketed))r.type.isTop&&(n=r);return n}function zi(s){let e=s.field(si.state,!1);return e?e.tree:Je.empty}var bf=class{constructor(e){this.doc=e,this.cursorPos=0,this.string="",this.cursor=e.iter()}get length(){return this.doc.length}syncTo(e){return this.string=this.cursor.next(e-this.cursorPos).value,this.cursorPos=e+this.string.length,this.cursorPos-this.string.length}chunk(e){return this.syncTo(e),this.string}get lineChunks(){return!0}read(e,t){let i=this.cursorPos-this.string.length;return e<i||t>=this.cursorPos?this.doc.sliceString(e,t):this.string.slice(e-i,t-i)}},zo=null,Vo=class s{constructor(e,t,i=[],n,r,o,a,l){this.parser=e,this.state=t,this.fragments=i,this.tree=n,this.treeLen=r,this.viewport=o,this.skipped=a,this.scheduleOn=l,this.parse=null,this.tempSkipped=[]}static create(e,t,i){return new s(e,t,[],Je.empty,0,i,[],null)}startParse(){return this.parser.startParse(new bf(this.state.doc),this.fragments)}work(e,t){return t!=null&&t>=this.state.doc.length&&(t=void 0),this.tree!=Je.empty&&this.isDone(t??this.state.doc.length)?(this.takeTree(),!0):this.withContext(()=>{var i;if(typeof e=="number"){let n=Date.now()+e;e=()=>Date.now()>n}for(this.parse||(this.parse=this.startParse()),t!=null&&(this.parse.stoppedAt==null||this.parse.stoppedAt>t)&&t<this.state.doc.length&&this.parse.stopAt(t);;){let n=this.parse.advance();if(n)if(this.fragments=this.withoutTempSkipped(Ss.addTree(n,this.fragments,this.parse.stoppedAt!=null)),this.treeLen=(i=this.parse.stoppedAt)!==null&&i!==void 0?i:this.state.doc.length,this.tree=n,this.parse=null,this.treeLen<(t??this.state.doc.length))this.parse=this.startParse();else return!0;if(e())return!1}})}takeTree(){let e,t;this.parse&&(e=this.parse.parsedPos)>=this.treeLen&&((this.parse.stoppedAt==null||this.parse.stoppedAt>e)&&this.parse.stopAt(e),this.withContext(()=>{for(;!(t=this.parse.advance()););}),this.treeLen=e,this.tree=t,this.fragments=this.withoutTempSkipped(Ss.addTree(this.tree,this.fragments,!0)),this.parse=null)}withContext(e){let t=zo;zo=this;try{return e()}finally{zo=t}}withoutTempSkipped(e){for(let t;t=this.tempSkipped.pop();)e=D0(e,t.from,t.to);return e}changes(e,t){let{fragments:i,tree:n,treeLen:r,viewport:o,skipped:a}=this;if(this.takeTree(),!e.empty){let l=[];if(e.iterChangedRanges((c,h,u,f)=>l.push({fromA:c,toA:h,fromB:u,toB:f})),i=Ss.applyChanges(i,l),n=Je.empty,r=0,o={from:e.mapPos(o.from,-1),to:e.mapPos(o.to,1)},this.skipped.length){a=[];for(let c of this.skipped){let h=e.mapPos(c.from,1),u=e.mapPos(c.to,-1);h<u&&a.push({from:h,to:u})}}}return new s(this.parser,t,i,n,r,o,a,this.scheduleOn)}updateViewport(e){if(this.viewport.from==e.from&&this.viewport.to==e.to)return!1;this.viewport=e;let t=this.skipped.length;for(let i=0;i<this.skipped.length;i++){let{from:n,to:r}=this.skipped[i];n<e.to&&r>e.from&&(this.fragments=D0(this.fragments,n,r),this.skipped.splice(i--,1))}return this.skipped.length>=t?!1:(this.reset(),!0)}reset(){this.parse&&(this.takeTree(),this.parse=null)}skipUntilInView(e,t){this.skipped.push({from:e,to:t})}static getSkippingParser(e){return new class extends Fo{createParse(t,i,n){let r=n[0].from,o=n[n.length-1].to;return{parsedPos:r,advance(){let l=zo;if(l){for(let c of n)l.tempSkipped.push(c);e&&(l.scheduleOn=l.scheduleOn?Promise.all([l.scheduleOn,e]):e)}return this.parsedPos=o,new Je(Ht.none,[],[],o-r)},stoppedAt:null,stopAt(){}}}}}isDone(e){e=Math.min(e,this.state.doc.length);let t=this.fragments;return this.treeLen>=e&&t.length&&t[0].from==0&&t[0].to>=e}static get(){return zo}};function D0(s,e,t){return Ss.applyChanges(s,[{fromA:e,toA:t,fromB:e,toB:t}])}var Ho=class s{constructor(e){this.context=e,this.tree=e.tree}apply(e){if(!e.docChanged&&this.tree==this.context.tree)return this;let t=this.context.changes(e.changes,e.state),i=this.context.treeLen==e.startState.doc.length?void 0:Math.max(e.changes.mapPos(this.context.treeLen),t.viewport.to);return t.work(20,i)||t.takeTree(),new s(t)}static init(e){let t=Math.min(3e3,e.doc.length),i=Vo.create(e.facet(Cr).parser,e,{from:0,to:t});return i.work(20,t)||i.takeTree(),new s(i)}};si.state=ot.define({create:Ho.init,update(s,e){for(let t of e.effects)if(t.is(si.setState))return t.value;return e.startState.facet(Cr)!=e.state.facet(Cr)?Ho.init(e.state):s.apply(e)}});var U0=s=>{let e=setTimeout(()=>s(),500);return()=>clearTimeout(e)};typeof requestIdleCallback<"u"&&(U0=s=>{let e=-1,t=setTimeout(()=>{e=requestIdleCallback(s,{timeout:400})},100);return()=>e<0?clearTimeout(t):cancelIdleCallback(e)});var xf=typeof navigator<"u"&&(!((gf=navigator.scheduling)===null||gf===void 0)&&gf.isInputPending)?()=>navigator.scheduling.isInputPending():null,Iw=_t.fromClass(class{constructor(e){this.view=e,this.working=null,this.workScheduled=0,this.chunkEnd=-1,this.chunkBudget=-1,this.work=this.work.bind(this),this.scheduleWork()}update(e){let t=this.view.state.field(si.state).context;(t.updateViewport(e.view.viewport)||this.view.viewport.to>t.treeLen)&&this.scheduleWork(),(e.docChanged||e.selectionSet)&&(this.view.hasFocus&&(this.chunkBudget+=50),this.scheduleWork()),this.checkAsyncSchedule(t)}scheduleWork(){if(this.working)return;let{state:e}=this.view,t=e.field(si.state);(t.tree!=t.context.tree||!t.context.isDone(e.doc.length))&&(this.working=U0(this.work))}work(e){this.working=null;let t=Date.now();if(this.chunkEnd<t&&(this.chunkEnd<0||this.view.hasFocus)&&(this.chunkEnd=t+3e4,this.chunkBudget=3e3),this.chunkBudget<=0)return;let{state:i,viewport:{to:n}}=this.view,r=i.field(si.state);if(r.tree==r.context.tree&&r.context.isDone(n+1e5))return;let o=Date.now()+Math.min(this.chunkBudget,100,e&&!xf?Math.max(25,e.timeRemaining()-5):1e9),a=r.context.treeLen<n&&i.doc.length>n+1e3,l=r.context.work(()=>xf&&xf()||Date.now()>o,n+(a?0:1e5));this.chunkBudget-=Date.now()-t,(l||this.chunkBudget<=0)&&(r.context.takeTree(),this.view.dispatch({effects:si.setState.of(new Ho(r.context))})),this.chunkBudget>0&&!(l&&!a)&&this.scheduleWork(),this.checkAsyncSchedule(r.context)}checkAsyncSchedule(e){e.scheduleOn&&(this.workScheduled++,e.scheduleOn.then(()=>this.scheduleWork()).catch(t=>ii(this.view.state,t)).then(()=>this.workScheduled--),e.scheduleOn=null)}destroy(){this.working&&this.working()}isWorking(){return!!(this.working||this.workScheduled>0)}},{eventHandlers:{focus(){this.scheduleWork()}}}),Cr=$.define({combine(s){return s.length?s[0]:null},enables:s=>[si.state,Iw,ee.contentAttributes.compute([s],e=>{let t=e.facet(s);return t&&t.name?{"data-language":t.name}:{}})]});var Dw=$.define(),Rl=$.define({combine:s=>{if(!s.length)return"  ";let e=s[0];if(!e||/\S/.test(e)||Array.from(e).some(t=>t!=e[0]))throw new Error("Invalid indent unit: "+JSON.stringify(s[0]));return e}});function Hn(s){let e=s.facet(Rl);return e.charCodeAt(0)==9?s.tabSize*e.length:e.length}function Wo(s,e){let t="",i=s.tabSize,n=s.facet(Rl)[0];if(n=="	"){for(;e>=i;)t+="	",e-=i;n=" "}for(let r=0;r<e;r++)t+=n;return t}function Ef(s,e){s instanceof Ue&&(s=new As(s));for(let i of s.state.facet(Dw)){let n=i(s,e);if(n!==void 0)return n}let t=zi(s.state);return t.length>=e?Nw(s,t,e):null}var As=class{constructor(e,t={}){this.state=e,this.options=t,this.unit=Hn(e)}lineAt(e,t=1){let i=this.state.doc.lineAt(e),{simulateBreak:n,simulateDoubleBreak:r}=this.options;return n!=null&&n>=i.from&&n<=i.to?r&&n==e?{text:"",from:e}:(t<0?n<e:n<=e)?{text:i.text.slice(n-i.from),from:n}:{text:i.text.slice(0,n-i.from),from:i.from}:i}textAfterPos(e,t=1){if(this.options.simulateDoubleBreak&&e==this.options.simulateBreak)return"";let{text:i,from:n}=this.lineAt(e,t);return i.slice(e-n,Math.min(i.length,e+100-n))}column(e,t=1){let{text:i,from:n}=this.lineAt(e,t),r=this.countColumn(i,e-n),o=this.options.overrideIndentation?this.options.overrideIndentation(n):-1;return o>-1&&(r+=o-this.countColumn(i,i.search(/\S|$/))),r}countColumn(e,t=e.length){return ps(e,this.state.tabSize,t)}lineIndent(e,t=1){let{text:i,from:n}=this.lineAt(e,t),r=this.options.overrideIndentation;if(r){let o=r(n);if(o>-1)return o}return this.countColumn(i,i.search(/\S|$/))}get simulatedBreak(){return this.options.simulateBreak||null}},z0=new me;function Nw(s,e,t){let i=e.resolveStack(t),n=e.resolveInner(t,-1).resolve(t,0).enterUnfinishedNodesBefore(t);if(n!=i.node){let r=[];for(let o=n;o&&!(o.from<i.node.from||o.to>i.node.to||o.from==i.node.from&&o.type==i.node.type);o=o.parent)r.push(o);for(let o=r.length-1;o>=0;o--)i={node:r[o],next:i}}return V0(i,s,t)}function V0(s,e,t){for(let i=s;i;i=i.next){let n=Fw(i.node);if(n)return n(_f.create(e,t,i))}return 0}function Ow(s){return s.pos==s.options.simulateBreak&&s.options.simulateDoubleBreak}function Fw(s){let e=s.type.prop(z0);if(e)return e;let t=s.firstChild,i;if(t&&(i=t.type.prop(me.closedBy))){let n=s.lastChild,r=n&&i.indexOf(n.name)>-1;return o=>Vw(o,!0,1,void 0,r&&!Ow(o)?n.from:void 0)}return s.parent==null?Bw:null}function Bw(){return 0}var _f=class s extends As{constructor(e,t,i){super(e.state,e.options),this.base=e,this.pos=t,this.context=i}get node(){return this.context.node}static create(e,t,i){return new s(e,t,i)}get textAfter(){return this.textAfterPos(this.pos)}get baseIndent(){return this.baseIndentFor(this.node)}baseIndentFor(e){let t=this.state.doc.lineAt(e.from);for(;;){let i=e.resolve(t.from);for(;i.parent&&i.parent.from==i.from;)i=i.parent;if(Uw(i,e))break;t=this.state.doc.lineAt(i.from)}return this.lineIndent(t.from)}continue(){return V0(this.context.next,this.base,this.pos)}};function Uw(s,e){for(let t=e;t;t=t.parent)if(s==t)return!0;return!1}function zw(s){let e=s.node,t=e.childAfter(e.from),i=e.lastChild;if(!t)return null;let n=s.options.simulateBreak,r=s.state.doc.lineAt(t.from),o=n==null||n<=r.from?r.to:Math.min(r.to,n);for(let a=t.to;;){let l=e.childAfter(a);if(!l||l==i)return null;if(!l.type.isSkipped){if(l.from>=o)return null;let c=/^ */.exec(r.text.slice(t.to-r.from))[0].length;return{from:t.from,to:t.to+c}}a=l.to}}function Vw(s,e,t,i,n){let r=s.textAfter,o=r.match(/^\s*/)[0].length,a=i&&r.slice(o,o+i.length)==i||n==s.pos+o,l=e?zw(s):null;return l?a?s.column(l.from):s.column(l.to):s.baseIndent+(a?0:s.unit*t)}var Rr=class s{constructor(e,t){this.specs=e;let i;function n(a){let l=yi.newName();return(i||(i=Object.create(null)))["."+l]=a,l}let r=typeof t.all=="string"?t.all:t.all?n(t.all):void 0,o=t.scope;this.scope=o instanceof si?a=>a.prop(Er)==o.data:o?a=>a==o:void 0,this.style=mf(e.map(a=>({tag:a.tag,class:a.class||n(Object.assign({},a,{tag:null}))})),{all:r}).style,this.module=i?new yi(i):null,this.themeType=t.themeType}static define(e,t){return new s(e,t||{})}},Sf=$.define(),H0=$.define({combine(s){return s.length?[s[0]]:null}});function vf(s){let e=s.facet(Sf);return e.length?e:s.facet(H0)}function G0(s,e){let t=[Hw],i;return s instanceof Rr&&(s.module&&t.push(ee.styleModule.of(s.module)),i=s.themeType),e?.fallback?t.push(H0.of(s)):i?t.push(Sf.computeN([ee.darkTheme],n=>n.facet(ee.darkTheme)==(i=="dark")?[s]:[])):t.push(Sf.of(s)),t}var wf=class{constructor(e){this.markCache=Object.create(null),this.tree=zi(e.state),this.decorations=this.buildDeco(e,vf(e.state)),this.decoratedTo=e.viewport.to}update(e){let t=zi(e.state),i=vf(e.state),n=i!=vf(e.startState),{viewport:r}=e.view,o=e.changes.mapPos(this.decoratedTo,1);t.length<r.to&&!n&&t.type==this.tree.type&&o>=r.to?(this.decorations=this.decorations.map(e.changes),this.decoratedTo=o):(t!=this.tree||e.viewportChanged||n)&&(this.tree=t,this.decorations=this.buildDeco(e.view,i),this.decoratedTo=r.to)}buildDeco(e,t){if(!t||!this.tree.length)return oe.none;let i=new xi;for(let{from:n,to:r}of e.visibleRanges)k0(this.tree,t,(o,a,l)=>{i.add(o,a,this.markCache[l]||(this.markCache[l]=oe.mark({class:l})))},n,r);return i.finish()}},Hw=Dn.high(_t.fromClass(wf,{decorations:s=>s.decorations})),v2=Rr.define([{tag:z.meta,color:"#404740"},{tag:z.link,textDecoration:"underline"},{tag:z.heading,textDecoration:"underline",fontWeight:"bold"},{tag:z.emphasis,fontStyle:"italic"},{tag:z.strong,fontWeight:"bold"},{tag:z.strikethrough,textDecoration:"line-through"},{tag:z.keyword,color:"#708"},{tag:[z.atom,z.bool,z.url,z.contentSeparator,z.labelName],color:"#219"},{tag:[z.literal,z.inserted],color:"#164"},{tag:[z.string,z.deleted],color:"#a11"},{tag:[z.regexp,z.escape,z.special(z.string)],color:"#e40"},{tag:z.definition(z.variableName),color:"#00f"},{tag:z.local(z.variableName),color:"#30a"},{tag:[z.typeName,z.namespace],color:"#085"},{tag:z.className,color:"#167"},{tag:[z.special(z.variableName),z.macroName],color:"#256"},{tag:z.definition(z.propertyName),color:"#00c"},{tag:z.comment,color:"#940"},{tag:z.invalid,color:"#f00"}]),Gw=ee.baseTheme({"&.cm-focused .cm-matchingBracket":{backgroundColor:"#328c8252"},"&.cm-focused .cm-nonmatchingBracket":{backgroundColor:"#bb555544"}}),W0=1e4,q0="()[]{}",X0=$.define({combine(s){return vi(s,{afterCursor:!0,brackets:q0,maxScanDistance:W0,renderMatch:Xw})}}),Ww=oe.mark({class:"cm-matchingBracket"}),qw=oe.mark({class:"cm-nonmatchingBracket"});function Xw(s){let e=[],t=s.matched?Ww:qw;return e.push(t.range(s.start.from,s.start.to)),s.end&&e.push(t.range(s.end.from,s.end.to)),e}function N0(s){let e=[],t=s.facet(X0);for(let i of s.selection.ranges){if(!i.empty)continue;let n=Ui(s,i.head,-1,t)||i.head>0&&Ui(s,i.head-1,1,t)||t.afterCursor&&(Ui(s,i.head,1,t)||i.head<s.doc.length&&Ui(s,i.head+1,-1,t));n&&(e=e.concat(t.renderMatch(n,s)))}return oe.set(e,!0)}var $w=_t.fromClass(class{constructor(s){this.paused=!1,this.decorations=N0(s.state)}update(s){(s.docChanged||s.selectionSet||this.paused)&&(s.view.composing?(this.decorations=this.decorations.map(s.changes),this.paused=!0):(this.decorations=N0(s.state),this.paused=!1))}},{decorations:s=>s.decorations}),Yw=[$w,Gw];function $0(s={}){return[X0.of(s),Yw]}var Kw=new me;function Mf(s,e,t){let i=s.prop(e<0?me.openedBy:me.closedBy);if(i)return i;if(s.name.length==1){let n=t.indexOf(s.name);if(n>-1&&n%2==(e<0?1:0))return[t[n+e]]}return null}function Af(s){let e=s.type.prop(Kw);return e?e(s.node):s}function Ui(s,e,t,i={}){let n=i.maxScanDistance||W0,r=i.brackets||q0,o=zi(s),a=o.resolveInner(e,t);for(let l=a;l;l=l.parent){let c=Mf(l.type,t,r);if(c&&l.from<l.to){let h=Af(l);if(h&&(t>0?e>=h.from&&e<h.to:e>h.from&&e<=h.to))return Jw(s,e,t,l,h,c,r)}}return Zw(s,e,t,o,a.type,n,r)}function Jw(s,e,t,i,n,r,o){let a=i.parent,l={from:n.from,to:n.to},c=0,h=a?.cursor();if(h&&(t<0?h.childBefore(i.from):h.childAfter(i.to)))do if(t<0?h.to<=i.from:h.from>=i.to){if(c==0&&r.indexOf(h.type.name)>-1&&h.from<h.to){let u=Af(h);return{start:l,end:u?{from:u.from,to:u.to}:void 0,matched:!0}}else if(Mf(h.type,t,o))c++;else if(Mf(h.type,-t,o)){if(c==0){let u=Af(h);return{start:l,end:u&&u.from<u.to?{from:u.from,to:u.to}:void 0,matched:!1}}c--}}while(t<0?h.prevSibling():h.nextSibling());return{start:l,matched:!1}}function Zw(s,e,t,i,n,r,o){if(t<0?!e:e==s.doc.length)return null;let a=t<0?s.sliceDoc(e-1,e):s.sliceDoc(e,e+1),l=o.indexOf(a);if(l<0||l%2==0!=t>0)return null;let c={from:t<0?e-1:e,to:t>0?e+1:e},h=s.doc.iterRange(e,t>0?s.doc.length:0),u=0;for(let f=0;!h.next().done&&f<=r;){let d=h.value;t<0&&(f+=d.length);let m=e+f*t;for(let g=t>0?0:d.length-1,y=t>0?d.length:-1;g!=y;g+=t){let _=o.indexOf(d[g]);if(!(_<0||i.resolveInner(m+g,1).type!=n))if(_%2==0==t>0)u++;else{if(u==1)return{start:c,end:{from:m+g,to:m+g+1},matched:_>>1==l>>1};u--}}t>0&&(f+=d.length)}return h.done?{start:c,matched:!1}:null}function jw(s){return{name:s.name||"",token:s.token,blankLine:s.blankLine||(()=>{}),startState:s.startState||(()=>!0),copyState:s.copyState||Qw,indent:s.indent||(()=>null),languageData:s.languageData||{},tokenTable:s.tokenTable||Rf,mergeTokens:s.mergeTokens!==!1}}function Qw(s){if(typeof s!="object")return s;let e={};for(let t in s){let i=s[t];e[t]=i instanceof Array?i.slice():i}return e}var O0=new WeakMap,El=class s extends si{constructor(e){let t=kw(e.languageData),i=jw(e),n,r=new class extends Fo{createParse(o,a,l){return new Tf(n,o,a,l)}};super(t,r,[],e.name),this.topNode=nM(t,this),n=this,this.streamParser=i,this.stateAfter=new me({perNode:!0}),this.tokenTable=e.tokenTable?new Cl(i.tokenTable):iM}static define(e){return new s(e)}getIndent(e){let t,{overrideIndentation:i}=e.options;i&&(t=O0.get(e.state),t!=null&&t<e.pos-1e4&&(t=void 0));let n=Cf(this,e.node.tree,e.node.from,e.node.from,t??e.pos),r,o;if(n?(o=n.state,r=n.pos+1):(o=this.streamParser.startState(e.unit),r=e.node.from),e.pos-r>1e4)return null;for(;r<e.pos;){let l=e.state.doc.lineAt(r),c=Math.min(e.pos,l.to);if(l.length){let h=i?i(l.from):-1,u=new Uo(l.text,e.state.tabSize,e.unit,h<0?void 0:h);for(;u.pos<c-l.from;)K0(this.streamParser.token,u,o)}else this.streamParser.blankLine(o,e.unit);if(c==e.pos)break;r=l.to+1}let a=e.lineAt(e.pos);return i&&t==null&&O0.set(e.state,a.from),this.streamParser.indent(o,/^\s*(.*)/.exec(a.text)[1],e)}get allowsNesting(){return!1}};function Cf(s,e,t,i,n){let r=t>=i&&t+e.length<=n&&e.prop(s.stateAfter);if(r)return{state:s.streamParser.copyState(r),pos:t+e.length};for(let o=e.children.length-1;o>=0;o--){let a=e.children[o],l=t+e.positions[o],c=a instanceof Je&&l<n&&Cf(s,a,l,i,n);if(c)return c}return null}function Y0(s,e,t,i,n){if(n&&t<=0&&i>=e.length)return e;!n&&t==0&&e.type==s.topNode&&(n=!0);for(let r=e.children.length-1;r>=0;r--){let o=e.positions[r],a=e.children[r],l;if(o<i&&a instanceof Je){if(!(l=Y0(s,a,t-o,i-o,n)))break;return n?new Je(e.type,e.children.slice(0,r).concat(l),e.positions.slice(0,r+1),o+l.length):l}}return null}function eM(s,e,t,i,n){for(let r of e){let o=r.from+(r.openStart?25:0),a=r.to-(r.openEnd?25:0),l=o<=t&&a>t&&Cf(s,r.tree,0-r.offset,t,a),c;if(l&&l.pos<=i&&(c=Y0(s,r.tree,t+r.offset,l.pos+r.offset,!1)))return{state:l.state,tree:c}}return{state:s.streamParser.startState(n?Hn(n):4),tree:Je.empty}}var Tf=class{constructor(e,t,i,n){this.lang=e,this.input=t,this.fragments=i,this.ranges=n,this.stoppedAt=null,this.chunks=[],this.chunkPos=[],this.chunk=[],this.chunkReused=void 0,this.rangeIndex=0,this.to=n[n.length-1].to;let r=Vo.get(),o=n[0].from,{state:a,tree:l}=eM(e,i,o,this.to,r?.state);this.state=a,this.parsedPos=this.chunkStart=o+l.length;for(let c=0;c<l.children.length;c++)this.chunks.push(l.children[c]),this.chunkPos.push(l.positions[c]);r&&this.parsedPos<r.viewport.from-1e5&&n.some(c=>c.from<=r.viewport.from&&c.to>=r.viewport.from)&&(this.state=this.lang.streamParser.startState(Hn(r.state)),r.skipUntilInView(this.parsedPos,r.viewport.from),this.parsedPos=r.viewport.from),this.moveRangeIndex()}advance(){let e=Vo.get(),t=this.stoppedAt==null?this.to:Math.min(this.to,this.stoppedAt),i=Math.min(t,this.chunkStart+512);for(e&&(i=Math.min(i,e.viewport.to));this.parsedPos<i;)this.parseLine(e);return this.chunkStart<this.parsedPos&&this.finishChunk(),this.parsedPos>=t?this.finish():e&&this.parsedPos>=e.viewport.to?(e.skipUntilInView(this.parsedPos,t),this.finish()):null}stopAt(e){this.stoppedAt=e}lineAfter(e){let t=this.input.chunk(e);if(this.input.lineChunks)t==`
`&&(t="");else{let i=t.indexOf(`
`);i>-1&&(t=t.slice(0,i))}return e+t.length<=this.to?t:t.slice(0,this.to-e)}nextLine(){let e=this.parsedPos,t=this.lineAfter(e),i=e+t.length;for(let n=this.rangeIndex;;){let r=this.ranges[n].to;if(r>=i||(t=t.slice(0,r-(i-t.length)),n++,n==this.ranges.length))break;let o=this.ranges[n].from,a=this.lineAfter(o);t+=a,i=o+a.length}return{line:t,end:i}}skipGapsTo(e,t,i){for(;;){let n=this.ranges[this.rangeIndex].to,r=e+t;if(i>0?n>r:n>=r)break;let o=this.ranges[++this.rangeIndex].from;t+=o-n}return t}moveRangeIndex(){for(;this.ranges[this.rangeIndex].to<this.parsedPos;)this.rangeIndex++}emitToken(e,t,i,n){let r=4;if(this.ranges.length>1){n=this.skipGapsTo(t,n,1),t+=n;let a=this.chunk.length;n=this.skipGapsTo(i,n,-1),i+=n,r+=this.chunk.length-a}let o=this.chunk.length-4;return this.lang.streamParser.mergeTokens&&r==4&&o>=0&&this.chunk[o]==e&&this.chunk[o+2]==t?this.chunk[o+2]=i:this.chunk.push(e,t,i,r),n}parseLine(e){let{line:t,end:i}=this.nextLine(),n=0,{streamParser:r}=this.lang,o=new Uo(t,e?e.state.tabSize:4,e?Hn(e.state):2);if(o.eol())r.blankLine(this.state,o.indentUnit);else for(;!o.eol();){let a=K0(r.token,o,this.state);if(a&&(n=this.emitToken(this.lang.tokenTable.resolve(a),this.parsedPos+o.start,this.parsedPos+o.pos,n)),o.start>1e4)break}this.parsedPos=i,this.moveRangeIndex(),this.parsedPos<this.to&&this.parsedPos++}finishChunk(){let e=Je.build({buffer:this.chunk,start:this.chunkStart,length:this.parsedPos-this.chunkStart,nodeSet:tM,topID:0,maxBufferLength:512,reused:this.chunkReused});e=new Je(e.type,e.children,e.positions,e.length,[[this.lang.stateAfter,this.lang.streamParser.copyState(this.state)]]),this.chunks.push(e),this.chunkPos.push(this.chunkStart-this.ranges[0].from),this.chunk=[],this.chunkReused=void 0,this.chunkStart=this.parsedPos}finish(){return new Je(this.lang.topNode,this.chunks,this.chunkPos,this.parsedPos-this.ranges[0].from).balance()}};function K0(s,e,t){e.start=e.pos;for(let i=0;i<10;i++){let n=s(e,t);if(e.pos>e.start)return n}throw new Error("Stream parser failed to advance stream.")}var Rf=Object.create(null),Go=[Ht.none],tM=new _l(Go),F0=[],B0=Object.create(null),J0=Object.create(null);for(let[s,e]of[["variable","variableName"],["variable-2","variableName.special"],["string-2","string.special"],["def","variableName.definition"],["tag","tagName"],["attribute","attributeName"],["type","typeName"],["builtin","variableName.standard"],["qualifier","modifier"],["error","invalid"],["header","heading"],["property","propertyName"]])J0[s]=Z0(Rf,e);var Cl=class{constructor(e){this.extra=e,this.table=Object.assign(Object.create(null),J0)}resolve(e){return e?this.table[e]||(this.table[e]=Z0(this.extra,e)):0}},iM=new Cl(Rf);function yf(s,e){F0.indexOf(s)>-1||(F0.push(s),console.warn(e))}function Z0(s,e){let t=[];for(let a of e.split(" ")){let l=[];for(let c of a.split(".")){let h=s[c]||z[c];h?typeof h=="function"?l.length?l=l.map(h):yf(c,`Modifier ${c} used at start of tag`):l.length?yf(c,`Tag ${c} used as modifier`):l=Array.isArray(h)?h:[h]:yf(c,`Unknown highlighting tag ${c}`)}for(let c of l)t.push(c)}if(!t.length)return 0;let i=e.replace(/ /g,"_"),n=i+" "+t.map(a=>a.id),r=B0[n];if(r)return r.id;let o=B0[n]=Ht.define({id:Go.length,name:i,props:[R0({[i]:t})]});return Go.push(o),o.id}function nM(s,e){let t=Ht.define({id:Go.length,name:"Document",props:[Er.add(()=>s),z0.add(()=>i=>e.getIndent(i))],top:!0});return Go.push(t),t}var y2={rtl:oe.mark({class:"cm-iso",inclusive:!0,attributes:{dir:"rtl"},bidiIsolate:Ie.RTL}),ltr:oe.mark({class:"cm-iso",inclusive:!0,attributes:{dir:"ltr"},bidiIsolate:Ie.LTR}),auto:oe.mark({class:"cm-iso",inclusive:!0,attributes:{dir:"auto"},bidiIsolate:null})};var sM=s=>{let{state:e}=s,t=e.doc.lineAt(e.selection.main.from),i=Nf(s.state,t.from);return i.line?rM(s):i.block?aM(s):!1};function Df(s,e){return({state:t,dispatch:i})=>{if(t.readOnly)return!1;let n=s(e,t);return n?(i(t.update(n)),!0):!1}}var rM=Df(hM,0);var oM=Df(ax,0);var aM=Df((s,e)=>ax(s,e,cM(e)),0);function Nf(s,e){let t=s.languageDataAt("commentTokens",e,1);return t.length?t[0]:{}}var qo=50;function lM(s,{open:e,close:t},i,n){let r=s.sliceDoc(i-qo,i),o=s.sliceDoc(n,n+qo),a=/\s*$/.exec(r)[0].length,l=/^\s*/.exec(o)[0].length,c=r.length-a;if(r.slice(c-e.length,c)==e&&o.slice(l,l+t.length)==t)return{open:{pos:i-a,margin:a&&1},close:{pos:n+l,margin:l&&1}};let h,u;n-i<=2*qo?h=u=s.sliceDoc(i,n):(h=s.sliceDoc(i,i+qo),u=s.sliceDoc(n-qo,n));let f=/^\s*/.exec(h)[0].length,d=/\s*$/.exec(u)[0].length,m=u.length-d-t.length;return h.slice(f,f+e.length)==e&&u.slice(m,m+t.length)==t?{open:{pos:i+f+e.length,margin:/\s/.test(h.charAt(f+e.length))?1:0},close:{pos:n-d-t.length,margin:/\s/.test(u.charAt(m-1))?1:0}}:null}function cM(s){let e=[];for(let t of s.selection.ranges){let i=s.doc.lineAt(t.from),n=t.to<=i.to?i:s.doc.lineAt(t.to);n.from>i.from&&n.from==t.to&&(n=t.to==i.to+1?i:s.doc.lineAt(t.to-1));let r=e.length-1;r>=0&&e[r].to>i.from?e[r].to=n.to:e.push({from:i.from+/^\s*/.exec(i.text)[0].length,to:n.to})}return e}function ax(s,e,t=e.selection.ranges){let i=t.map(r=>Nf(e,r.from).block);if(!i.every(r=>r))return null;let n=t.map((r,o)=>lM(e,i[o],r.from,r.to));if(s!=2&&!n.every(r=>r))return{changes:e.changes(t.map((r,o)=>n[o]?[]:[{from:r.from,insert:i[o].open+" "},{from:r.to,insert:" "+i[o].close}]))};if(s!=1&&n.some(r=>r)){let r=[];for(let o=0,a;o<n.length;o++)if(a=n[o]){let l=i[o],{open:c,close:h}=a;r.push({from:c.pos-l.open.length,to:c.pos+c.margin},{from:h.pos-h.margin,to:h.pos+l.close.length})}return{changes:r}}return null}function hM(s,e,t=e.selection.ranges){let i=[],n=-1;e:for(let{from:r,to:o}of t){let a=i.length,l=1e9,c;for(let h=r;h<=o;){let u=e.doc.lineAt(h);if(c==null&&(c=Nf(e,u.from).line,!c))continue e;if(u.from>n&&(r==o||o>u.from)){n=u.from;let f=/^\s*/.exec(u.text)[0].length,d=f==u.length,m=u.text.slice(f,f+c.length)==c?f:-1;f<u.text.length&&f<l&&(l=f),i.push({line:u,comment:m,token:c,indent:f,empty:d,single:!1})}h=u.to+1}if(l<1e9)for(let h=a;h<i.length;h++)i[h].indent<i[h].line.text.length&&(i[h].indent=l);i.length==a+1&&(i[a].single=!0)}if(s!=2&&i.some(r=>r.comment<0&&(!r.empty||r.single))){let r=[];for(let{line:a,token:l,indent:c,empty:h,single:u}of i)(u||!h)&&r.push({from:a.from+c,insert:l+" "});let o=e.changes(r);return{changes:o,selection:e.selection.map(o,1)}}else if(s!=1&&i.some(r=>r.comment>=0)){let r=[];for(let{line:o,comment:a,token:l}of i)if(a>=0){let c=o.from+a,h=c+l.length;o.text[h-o.from]==" "&&h++,r.push({from:c,to:h})}return{changes:r}}return null}var j0=Di.define();var uM=$.define();var Ts=class s{constructor(e,t,i,n,r){this.changes=e,this.effects=t,this.mapped=i,this.startSelection=n,this.selectionsAfter=r}setSelAfter(e){return new s(this.changes,this.effects,this.mapped,this.startSelection,e)}toJSON(){var e,t,i;return{changes:(e=this.changes)===null||e===void 0?void 0:e.toJSON(),mapped:(t=this.mapped)===null||t===void 0?void 0:t.toJSON(),startSelection:(i=this.startSelection)===null||i===void 0?void 0:i.toJSON(),selectionsAfter:this.selectionsAfter.map(n=>n.toJSON())}}static fromJSON(e){return new s(e.changes&&Ut.fromJSON(e.changes),[],e.mapped&&mn.fromJSON(e.mapped),e.startSelection&&I.fromJSON(e.startSelection),e.selectionsAfter.map(I.fromJSON))}static fromTransaction(e,t){let i=Mi;for(let n of e.startState.facet(uM)){let r=n(e);r.length&&(i=i.concat(r))}return!i.length&&e.changes.empty?null:new s(e.changes.invert(e.startState.doc),i,void 0,t||e.startState.selection,Mi)}static selection(e){return new s(void 0,Mi,void 0,void 0,e)}};function kf(s,e,t,i){let n=e+1>t+20?e-t-1:0,r=s.slice(n,e);return r.push(i),r}function fM(s,e){let t=[],i=!1;return s.iterChangedRanges((n,r)=>t.push(n,r)),e.iterChangedRanges((n,r,o,a)=>{for(let l=0;l<t.length;){let c=t[l++],h=t[l++];a>=c&&o<=h&&(i=!0)}}),i}function dM(s,e){return s.ranges.length==e.ranges.length&&s.ranges.filter((t,i)=>t.empty!=e.ranges[i].empty).length===0}function lx(s,e){return s.length?e.length?s.concat(e):s:e}var Mi=[],pM=200;function mM(s,e){if(s.length){let t=s[s.length-1],i=t.selectionsAfter.slice(Math.max(0,t.selectionsAfter.length-pM));return i.length&&i[i.length-1].eq(e)?s:(i.push(e),kf(s,s.length-1,1e9,t.setSelAfter(i)))}else return[Ts.selection([e])]}function gM(s){let e=s[s.length-1],t=s.slice();return t[s.length-1]=e.setSelAfter(e.selectionsAfter.slice(0,e.selectionsAfter.length-1)),t}function Pf(s,e){if(!s.length)return s;let t=s.length,i=Mi;for(;t;){let n=xM(s[t-1],e,i);if(n.changes&&!n.changes.empty||n.effects.length){let r=s.slice(0,t);return r[t-1]=n,r}else e=n.mapped,t--,i=n.selectionsAfter}return i.length?[Ts.selection(i)]:Mi}function xM(s,e,t){let i=lx(s.selectionsAfter.length?s.selectionsAfter.map(a=>a.map(e)):Mi,t);if(!s.changes)return Ts.selection(i);let n=s.changes.map(e),r=e.mapDesc(s.changes,!0),o=s.mapped?s.mapped.composeDesc(r):r;return new Ts(n,de.mapEffects(s.effects,e),o,s.startSelection.map(r),i)}var vM=/^(input\.type|delete)($|\.)/,kl=class s{constructor(e,t,i=0,n=void 0){this.done=e,this.undone=t,this.prevTime=i,this.prevUserEvent=n}isolate(){return this.prevTime?new s(this.done,this.undone):this}addChanges(e,t,i,n,r){let o=this.done,a=o[o.length-1];return a&&a.changes&&!a.changes.empty&&e.changes&&(!i||vM.test(i))&&(!a.selectionsAfter.length&&t-this.prevTime<n.newGroupDelay&&n.joinToEvent(r,fM(a.changes,e.changes))||i=="input.type.compose")?o=kf(o,o.length-1,n.minDepth,new Ts(e.changes.compose(a.changes),lx(de.mapEffects(e.effects,a.changes),a.effects),a.mapped,a.startSelection,Mi)):o=kf(o,o.length,n.minDepth,e),new s(o,Mi,t,i)}addSelection(e,t,i,n){let r=this.done.length?this.done[this.done.length-1].selectionsAfter:Mi;return r.length>0&&t-this.prevTime<n&&i==this.prevUserEvent&&i&&/^select($|\.)/.test(i)&&dM(r[r.length-1],e)?this:new s(mM(this.done,e),this.undone,t,i)}addMapping(e){return new s(Pf(this.done,e),Pf(this.undone,e),this.prevTime,this.prevUserEvent)}pop(e,t,i){let n=e==0?this.done:this.undone;if(n.length==0)return null;let r=n[n.length-1],o=r.selectionsAfter[0]||(r.startSelection?r.startSelection.map(r.changes.invertedDesc,1):t.selection);if(i&&r.selectionsAfter.length)return t.update({selection:r.selectionsAfter[r.selectionsAfter.length-1],annotations:j0.of({side:e,rest:gM(n),selection:o}),userEvent:e==0?"select.undo":"select.redo",scrollIntoView:!0});if(r.changes){let a=n.length==1?Mi:n.slice(0,n.length-1);return r.mapped&&(a=Pf(a,r.mapped)),t.update({changes:r.changes,selection:r.startSelection,effects:r.effects,annotations:j0.of({side:e,rest:a,selection:o}),filter:!1,userEvent:e==0?"undo":"redo",scrollIntoView:!0})}else return null}};kl.empty=new kl(Mi,Mi);function Pr(s,e){return I.create(s.ranges.map(e),s.mainIndex)}function Vi(s,e){return s.update({selection:e,scrollIntoView:!0,userEvent:"select"})}function Hi({state:s,dispatch:e},t){let i=Pr(s.selection,t);return i.eq(s.selection,!0)?!1:(e(Vi(s,i)),!0)}function Ll(s,e){return I.cursor(e?s.to:s.from)}function cx(s,e){return Hi(s,t=>t.empty?s.moveByChar(t,e):Ll(t,e))}function Pt(s){return s.textDirectionAt(s.state.selection.main.head)==Ie.LTR}var hx=s=>cx(s,!Pt(s)),ux=s=>cx(s,Pt(s));function fx(s,e){return Hi(s,t=>t.empty?s.moveByGroup(t,e):Ll(t,e))}var yM=s=>fx(s,!Pt(s)),bM=s=>fx(s,Pt(s));var C2=typeof Intl<"u"&&Intl.Segmenter?new Intl.Segmenter(void 0,{granularity:"word"}):null;function _M(s,e,t){if(e.type.prop(t))return!0;let i=e.to-e.from;return i&&(i>2||/[^\s,.;:]/.test(s.sliceDoc(e.from,e.to)))||e.firstChild}function Il(s,e,t){let i=zi(s).resolveInner(e.head),n=t?me.closedBy:me.openedBy;for(let l=e.head;;){let c=t?i.childAfter(l):i.childBefore(l);if(!c)break;_M(s,c,n)?i=c:l=t?c.to:c.from}let r=i.type.prop(n),o,a;return r&&(o=t?Ui(s,i.from,1):Ui(s,i.to,-1))&&o.matched?a=t?o.end.to:o.end.from:a=t?i.to:i.from,I.cursor(a,t?-1:1)}var SM=s=>Hi(s,e=>Il(s.state,e,!Pt(s))),wM=s=>Hi(s,e=>Il(s.state,e,Pt(s)));function dx(s,e){return Hi(s,t=>{if(!t.empty)return Ll(t,e);let i=s.moveVertically(t,e);return i.head!=t.head?i:s.moveToLineBoundary(t,e)})}var px=s=>dx(s,!1),mx=s=>dx(s,!0);function gx(s){let e=s.scrollDOM.clientHeight<s.scrollDOM.scrollHeight-2,t=0,i=0,n;if(e){for(let r of s.state.facet(ee.scrollMargins)){let o=r(s);o?.top&&(t=Math.max(o?.top,t)),o?.bottom&&(i=Math.max(o?.bottom,i))}n=s.scrollDOM.clientHeight-t-i}else n=(s.dom.ownerDocument.defaultView||window).innerHeight;return{marginTop:t,marginBottom:i,selfScroll:e,height:Math.max(s.defaultLineHeight,n-5)}}function xx(s,e){let t=gx(s),{state:i}=s,n=Pr(i.selection,o=>o.empty?s.moveVertically(o,e,t.height):Ll(o,e));if(n.eq(i.selection))return!1;let r;if(t.selfScroll){let o=s.coordsAtPos(i.selection.main.head),a=s.scrollDOM.getBoundingClientRect(),l=a.top+t.marginTop,c=a.bottom-t.marginBottom;o&&o.top>l&&o.bottom<c&&(r=ee.scrollIntoView(n.main.head,{y:"start",yMargin:o.top-l}))}return s.dispatch(Vi(i,n),{effects:r}),!0}var Q0=s=>xx(s,!1),Lf=s=>xx(s,!0);function Gn(s,e,t){let i=s.lineBlockAt(e.head),n=s.moveToLineBoundary(e,t);if(n.head==e.head&&n.head!=(t?i.to:i.from)&&(n=s.moveToLineBoundary(e,t,!1)),!t&&n.head==i.from&&i.length){let r=/^\s*/.exec(s.state.sliceDoc(i.from,Math.min(i.from+100,i.to)))[0].length;r&&e.head!=i.from+r&&(n=I.cursor(i.from+r))}return n}var MM=s=>Hi(s,e=>Gn(s,e,!0)),AM=s=>Hi(s,e=>Gn(s,e,!1)),TM=s=>Hi(s,e=>Gn(s,e,!Pt(s))),EM=s=>Hi(s,e=>Gn(s,e,Pt(s))),CM=s=>Hi(s,e=>s.moveToLineBoundary(e,!1,!1)),RM=s=>Hi(s,e=>s.moveToLineBoundary(e,!0,!1));function PM(s,e,t){let i=!1,n=Pr(s.selection,r=>{let o=Ui(s,r.head,-1)||Ui(s,r.head,1)||r.head>0&&Ui(s,r.head-1,1)||r.head<s.doc.length&&Ui(s,r.head+1,-1);if(!o||!o.end)return r;i=!0;let a=o.start.from==r.head?o.end.to:o.end.from;return t?I.range(r.anchor,a):I.cursor(a)});return i?(e(Vi(s,n)),!0):!1}var kM=({state:s,dispatch:e})=>PM(s,e,!1);function Ai(s,e,t){let i=Pr(s.state.selection,n=>{n.undirectional&&n.head>=n.anchor!=e&&(n=I.range(n.head,n.anchor));let r=t(n);return I.range(n.anchor,r.head,r.goalColumn,r.bidiLevel||void 0,r.assoc)});return i.eq(s.state.selection)?!1:(s.dispatch(Vi(s.state,i)),!0)}function vx(s,e){return Ai(s,e,t=>s.moveByChar(t,e))}var yx=s=>vx(s,!Pt(s)),bx=s=>vx(s,Pt(s));function _x(s,e){return Ai(s,e,t=>s.moveByGroup(t,e))}var LM=s=>_x(s,!Pt(s)),IM=s=>_x(s,Pt(s));var DM=s=>{let e=!Pt(s);return Ai(s,e,t=>Il(s.state,t,e))},NM=s=>{let e=Pt(s);return Ai(s,e,t=>Il(s.state,t,e))};function Sx(s,e){return Ai(s,e,t=>s.moveVertically(t,e))}var wx=s=>Sx(s,!1),Mx=s=>Sx(s,!0);function Ax(s,e){return Ai(s,e,t=>s.moveVertically(t,e,gx(s).height))}var ex=s=>Ax(s,!1),tx=s=>Ax(s,!0),OM=s=>Ai(s,!0,e=>Gn(s,e,!0)),FM=s=>Ai(s,!1,e=>Gn(s,e,!1)),BM=s=>{let e=!Pt(s);return Ai(s,e,t=>Gn(s,t,e))},UM=s=>{let e=Pt(s);return Ai(s,e,t=>Gn(s,t,e))},zM=s=>Ai(s,!1,e=>I.cursor(s.lineBlockAt(e.head).from)),VM=s=>Ai(s,!0,e=>I.cursor(s.lineBlockAt(e.head).to)),ix=({state:s,dispatch:e})=>(e(Vi(s,{anchor:0})),!0),nx=({state:s,dispatch:e})=>(e(Vi(s,{anchor:s.doc.length})),!0),sx=({state:s,dispatch:e})=>(e(Vi(s,{anchor:s.selection.main.anchor,head:0})),!0),rx=({state:s,dispatch:e})=>(e(Vi(s,{anchor:s.selection.main.anchor,head:s.doc.length})),!0),HM=({state:s,dispatch:e})=>(e(s.update({selection:{anchor:0,head:s.doc.length},userEvent:"select"})),!0),GM=({state:s,dispatch:e})=>{let t=Dl(s).map(({from:i,to:n})=>I.undirectionalRange(i,Math.min(n+1,s.doc.length)));return e(s.update({selection:I.create(t),userEvent:"select"})),!0},WM=({state:s,dispatch:e})=>{let t=Pr(s.selection,i=>{let n=zi(s),r=n.resolveStack(i.from,1);if(i.empty){let o=n.resolveStack(i.from,-1);o.node.from>=r.node.from&&o.node.to<=r.node.to&&(r=o)}for(let o=r;o;o=o.next){let{node:a}=o;if((a.from<i.from&&a.to>=i.to||a.to>i.to&&a.from<=i.from)&&o.next)return I.undirectionalRange(a.from,a.to)}return i});return t.eq(s.selection)?!1:(e(Vi(s,t)),!0)};function Tx(s,e){let{state:t}=s,i=t.selection,n=t.selection.ranges.slice();for(let r of t.selection.ranges){let o=t.doc.lineAt(r.head);if(e?o.to<s.state.doc.length:o.from>0)for(let a=r;;){let l=s.moveVertically(a,e);if(l.head<o.from||l.head>o.to){n.some(c=>c.head==l.head)||n.push(l);break}else{if(l.head==a.head)break;a=l}}}return n.length==i.ranges.length?!1:(s.dispatch(Vi(t,I.create(n,n.length-1))),!0)}var qM=s=>Tx(s,!1),XM=s=>Tx(s,!0),$M=({state:s,dispatch:e})=>{let t=s.selection,i=null;return t.ranges.length>1?i=I.create([t.main]):t.main.empty||(i=I.create([I.cursor(t.main.head)])),i?(e(Vi(s,i)),!0):!1};function Xo(s,e){if(s.state.readOnly)return!1;let t="delete.selection",{state:i}=s,n=i.changeByRange(r=>{let{from:o,to:a}=r;if(o==a){let l=e(r);l<o?(t="delete.backward",l=Pl(s,l,!1)):l>o&&(t="delete.forward",l=Pl(s,l,!0)),o=Math.min(o,l),a=Math.max(a,l)}else o=Pl(s,o,!1),a=Pl(s,a,!0);return o==a?{range:r}:{changes:{from:o,to:a},range:I.cursor(o,o<r.head?-1:1)}});return n.changes.empty?!1:(s.dispatch(i.update(n,{scrollIntoView:!0,userEvent:t,effects:t=="delete.selection"?ee.announce.of(i.phrase("Selection deleted")):void 0})),!0)}function Pl(s,e,t){if(s instanceof ee)for(let i of s.state.facet(ee.atomicRanges).map(n=>n(s)))i.between(e,e,(n,r)=>{n<e&&r>e&&(e=t?r:n)});return e}var Ex=(s,e,t)=>Xo(s,i=>{let n=i.from,{state:r}=s,o=r.doc.lineAt(n),a,l;if(t&&!e&&n>o.from&&n<o.from+200&&!/[^ \t]/.test(a=o.text.slice(0,n-o.from))){if(a[a.length-1]=="	")return n-1;let c=ps(a,r.tabSize),h=c%Hn(r)||Hn(r);for(let u=0;u<h&&a[a.length-1-u]==" ";u++)n--;l=n}else l=nt(o.text,n-o.from,e,e)+o.from,l==n&&o.number!=(e?r.doc.lines:1)?l+=e?1:-1:!e&&/[\ufe00-\ufe0f]/.test(o.text.slice(l-o.from,n-o.from))&&(l=nt(o.text,l-o.from,!1,!1)+o.from);return l}),If=s=>Ex(s,!1,!0);var Cx=s=>Ex(s,!0,!1),Rx=(s,e)=>Xo(s,t=>{let i=t.head,{state:n}=s,r=n.doc.lineAt(i),o=n.charCategorizer(i);for(let a=null;;){if(i==(e?r.to:r.from)){i==t.head&&r.number!=(e?n.doc.lines:1)&&(i+=e?1:-1);break}let l=nt(r.text,i-r.from,e)+r.from,c=r.text.slice(Math.min(i,l)-r.from,Math.max(i,l)-r.from),h=o(c);if(a!=null&&h!=a)break;(c!=" "||i!=t.head)&&(a=h),i=l}return i}),Px=s=>Rx(s,!1),YM=s=>Rx(s,!0);var KM=s=>Xo(s,e=>{let t=s.lineBlockAt(e.head).to;return e.head<t?t:Math.min(s.state.doc.length,e.head+1)});var JM=s=>Xo(s,e=>{let t=s.moveToLineBoundary(e,!1).head;return e.head>t?t:Math.max(0,e.head-1)}),ZM=s=>Xo(s,e=>{let t=s.moveToLineBoundary(e,!0).head;return e.head<t?t:Math.min(s.state.doc.length,e.head+1)});var jM=({state:s,dispatch:e})=>{if(s.readOnly)return!1;let t=s.changeByRange(i=>({changes:{from:i.from,to:i.to,insert:be.of(["",""])},range:I.cursor(i.from)}));return e(s.update(t,{scrollIntoView:!0,userEvent:"input"})),!0},QM=({state:s,dispatch:e})=>{if(s.readOnly)return!1;let t=s.changeByRange(i=>{if(!i.empty||i.from==0||i.from==s.doc.length)return{range:i};let n=i.from,r=s.doc.lineAt(n),o=n==r.from?n-1:nt(r.text,n-r.from,!1)+r.from,a=n==r.to?n+1:nt(r.text,n-r.from,!0)+r.from;return{changes:{from:o,to:a,insert:s.doc.slice(n,a).append(s.doc.slice(o,n))},range:I.cursor(a)}});return t.changes.empty?!1:(e(s.update(t,{scrollIntoView:!0,userEvent:"move.character"})),!0)};function Dl(s){let e=[],t=-1;for(let i of s.selection.ranges){let n=s.doc.lineAt(i.from),r=s.doc.lineAt(i.to);if(!i.empty&&i.to==r.from&&(r=s.doc.lineAt(i.to-1)),t>=n.number){let o=e[e.length-1];o.to=r.to,o.ranges.push(i)}else e.push({from:n.from,to:r.to,ranges:[i]});t=r.number+1}return e}function kx(s,e,t){if(s.readOnly)return!1;let i=[],n=[];for(let r of Dl(s)){if(t?r.to==s.doc.length:r.from==0)continue;let o=s.doc.lineAt(t?r.to+1:r.from-1),a=o.length+1;if(t){i.push({from:r.to,to:o.to},{from:r.from,insert:o.text+s.lineBreak});for(let l of r.ranges)n.push(I.range(Math.min(s.doc.length,l.anchor+a),Math.min(s.doc.length,l.head+a)))}else{i.push({from:o.from,to:r.from},{from:r.to,insert:s.lineBreak+o.text});for(let l of r.ranges)n.push(I.range(l.anchor-a,l.head-a))}}return i.length?(e(s.update({changes:i,scrollIntoView:!0,selection:I.create(n,s.selection.mainIndex),userEvent:"move.line"})),!0):!1}var e1=({state:s,dispatch:e})=>kx(s,e,!1),t1=({state:s,dispatch:e})=>kx(s,e,!0);function Lx(s,e,t){if(s.readOnly)return!1;let i=[];for(let r of Dl(s))t?i.push({from:r.from,insert:s.doc.slice(r.from,r.to)+s.lineBreak}):i.push({from:r.to,insert:s.lineBreak+s.doc.slice(r.from,r.to)});let n=s.changes(i);return e(s.update({changes:n,selection:s.selection.map(n,t?1:-1),scrollIntoView:!0,userEvent:"input.copyline"})),!0}var i1=({state:s,dispatch:e})=>Lx(s,e,!1),n1=({state:s,dispatch:e})=>Lx(s,e,!0),s1=s=>{if(s.state.readOnly)return!1;let{state:e}=s,t=e.changes(Dl(e).map(({from:n,to:r})=>(n>0?n--:r<e.doc.length&&r++,{from:n,to:r}))),i=Pr(e.selection,n=>{let r;if(s.lineWrapping){let o=s.lineBlockAt(n.head),a=s.coordsAtPos(n.head,n.assoc||1);a&&(r=o.bottom+s.documentTop-a.bottom+s.defaultLineHeight/2)}return s.moveVertically(n,!0,r)}).map(t);return s.dispatch({changes:t,selection:i,scrollIntoView:!0,userEvent:"delete.line"}),!0};function r1(s,e){if(/\(\)|\[\]|\{\}/.test(s.sliceDoc(e-1,e+1)))return{from:e,to:e};let t=zi(s).resolveInner(e),i=t.childBefore(e),n=t.childAfter(e),r;return i&&n&&i.to<=e&&n.from>=e&&(r=i.type.prop(me.closedBy))&&r.indexOf(n.name)>-1&&s.doc.lineAt(i.to).from==s.doc.lineAt(n.from).from&&!/\S/.test(s.sliceDoc(i.to,n.from))?{from:i.to,to:n.from}:null}var ox=Ix(!1),o1=Ix(!0);function Ix(s){return({state:e,dispatch:t})=>{if(e.readOnly)return!1;let i=e.changeByRange(n=>{let{from:r,to:o}=n,a=e.doc.lineAt(r),l=!s&&r==o&&r1(e,r);s&&(r=o=(o<=a.to?a:e.doc.lineAt(o)).to);let c=new As(e,{simulateBreak:r,simulateDoubleBreak:!!l}),h=Ef(c,r);for(h==null&&(h=ps(/^\s*/.exec(e.doc.lineAt(r).text)[0],e.tabSize));o<a.to&&/\s/.test(a.text[o-a.from]);)o++;l?{from:r,to:o}=l:r>a.from&&r<a.from+100&&!/\S/.test(a.text.slice(0,r))&&(r=a.from);let u=["",Wo(e,h)];return l&&u.push(Wo(e,c.lineIndent(a.from,-1))),{changes:{from:r,to:o,insert:be.of(u)},range:I.cursor(r+1+u[1].length)}});return t(e.update(i,{scrollIntoView:!0,userEvent:"input"})),!0}}function Of(s,e){let t=-1;return s.changeByRange(i=>{let n=[];for(let o=i.from;o<=i.to;){let a=s.doc.lineAt(o);a.number>t&&(i.empty||i.to>a.from)&&(e(a,n,i),t=a.number),o=a.to+1}let r=s.changes(n);return{changes:n,range:I.range(r.mapPos(i.anchor,1),r.mapPos(i.head,1))}})}var a1=({state:s,dispatch:e})=>{if(s.readOnly)return!1;let t=Object.create(null),i=new As(s,{overrideIndentation:r=>{let o=t[r];return o??-1}}),n=Of(s,(r,o,a)=>{let l=Ef(i,r.from);if(l==null)return;/\S/.test(r.text)||(l=0);let c=/^\s*/.exec(r.text)[0],h=Wo(s,l);(c!=h||a.from<r.from+c.length)&&(t[r.from]=l,o.push({from:r.from,to:r.from+c.length,insert:h}))});return n.changes.empty||e(s.update(n,{userEvent:"indent"})),!0},Dx=({state:s,dispatch:e})=>s.readOnly?!1:(e(s.update(Of(s,(t,i)=>{i.push({from:t.from,insert:s.facet(Rl)})}),{userEvent:"input.indent"})),!0),Nx=({state:s,dispatch:e})=>s.readOnly?!1:(e(s.update(Of(s,(t,i)=>{let n=/^\s*/.exec(t.text)[0];if(!n)return;let r=ps(n,s.tabSize),o=0,a=Wo(s,Math.max(0,r-Hn(s)));for(;o<n.length&&o<a.length&&n.charCodeAt(o)==a.charCodeAt(o);)o++;i.push({from:t.from+o,to:t.from+n.length,insert:a.slice(o)})}),{userEvent:"delete.dedent"})),!0),l1=s=>(s.setTabFocusMode(),!0);var c1=[{key:"Ctrl-b",run:hx,shift:yx,preventDefault:!0},{key:"Ctrl-f",run:ux,shift:bx},{key:"Ctrl-p",run:px,shift:wx},{key:"Ctrl-n",run:mx,shift:Mx},{key:"Ctrl-a",run:CM,shift:zM},{key:"Ctrl-e",run:RM,shift:VM},{key:"Ctrl-d",run:Cx},{key:"Ctrl-h",run:If},{key:"Ctrl-k",run:KM},{key:"Ctrl-Alt-h",run:Px},{key:"Ctrl-o",run:jM},{key:"Ctrl-t",run:QM},{key:"Ctrl-v",run:Lf}],h1=[{key:"ArrowLeft",run:hx,shift:yx,preventDefault:!0},{key:"Mod-ArrowLeft",mac:"Alt-ArrowLeft",run:yM,shift:LM,preventDefault:!0},{mac:"Cmd-ArrowLeft",run:TM,shift:BM,preventDefault:!0},{key:"ArrowRight",run:ux,shift:bx,preventDefault:!0},{key:"Mod-ArrowRight",mac:"Alt-ArrowRight",run:bM,shift:IM,preventDefault:!0},{mac:"Cmd-ArrowRight",run:EM,shift:UM,preventDefault:!0},{key:"ArrowUp",run:px,shift:wx,preventDefault:!0},{mac:"Cmd-ArrowUp",run:ix,shift:sx},{mac:"Ctrl-ArrowUp",run:Q0,shift:ex},{key:"ArrowDown",run:mx,shift:Mx,preventDefault:!0},{mac:"Cmd-ArrowDown",run:nx,shift:rx},{mac:"Ctrl-ArrowDown",run:Lf,shift:tx},{key:"PageUp",run:Q0,shift:ex},{key:"PageDown",run:Lf,shift:tx},{key:"Home",run:AM,shift:FM,preventDefault:!0},{key:"Mod-Home",run:ix,shift:sx},{key:"End",run:MM,shift:OM,preventDefault:!0},{key:"Mod-End",run:nx,shift:rx},{key:"Enter",run:ox,shift:ox},{key:"Mod-a",run:HM},{key:"Backspace",run:If,shift:If,preventDefault:!0},{key:"Delete",run:Cx,preventDefault:!0},{key:"Mod-Backspace",mac:"Alt-Backspace",run:Px,preventDefault:!0},{key:"Mod-Delete",mac:"Alt-Delete",run:YM,preventDefault:!0},{mac:"Mod-Backspace",run:JM,preventDefault:!0},{mac:"Mod-Delete",run:ZM,preventDefault:!0}].concat(c1.map(s=>({mac:s.key,run:s.run,shift:s.shift}))),Ox=[{key:"Alt-ArrowLeft",mac:"Ctrl-ArrowLeft",run:SM,shift:DM},{key:"Alt-ArrowRight",mac:"Ctrl-ArrowRight",run:wM,shift:NM},{key:"Alt-ArrowUp",run:e1},{key:"Shift-Alt-ArrowUp",run:i1},{key:"Alt-ArrowDown",run:t1},{key:"Shift-Alt-ArrowDown",run:n1},{key:"Mod-Alt-ArrowUp",run:qM},{key:"Mod-Alt-ArrowDown",run:XM},{key:"Escape",run:$M},{key:"Mod-Enter",run:o1},{key:"Alt-l",mac:"Ctrl-l",run:GM},{key:"Mod-i",run:WM,preventDefault:!0},{key:"Mod-[",run:Nx},{key:"Mod-]",run:Dx},{key:"Mod-Alt-\\",run:a1},{key:"Shift-Mod-k",run:s1},{key:"Shift-Mod-\\",run:kM},{key:"Mod-/",run:sM},{key:"Alt-A",mac:"Ctrl-A",run:oM},{key:"Ctrl-m",mac:"Shift-Alt-m",run:l1}].concat(h1),Fx={key:"Tab",run:Dx,shift:Nx};var Bx={name:"toml",startState:function(){return{inString:!1,stringType:"",lhs:!0,inArray:0}},token:function(s,e){let t;if(!e.inString&&(t=s.match(/^('''|"""|'|")/))&&(e.stringType=t[0],e.inString=!0),s.sol()&&!e.inString&&e.inArray===0&&(e.lhs=!0),e.inString){for(;e.inString;)if(s.match(e.stringType))e.inString=!1;else if(s.peek()==="\\")s.next(),s.next();else{if(s.eol())break;s.match(/^.[^\\\"\']*/)}return e.lhs?"property":"string"}else{if(e.inArray&&s.peek()==="]")return s.next(),e.inArray--,"bracket";if(e.lhs&&s.peek()==="["&&s.skipTo("]"))return s.next(),s.peek()==="]"&&s.next(),"atom";if(s.peek()==="#")return s.skipToEnd(),"comment";if(s.eatSpace())return null;if(e.lhs&&s.eatWhile(function(i){return i!="="&&i!=" "}))return"property";if(e.lhs&&s.peek()==="=")return s.next(),e.lhs=!1,null;if(!e.lhs&&s.match(/^\d\d\d\d[\d\-\:\.T]*Z/))return"atom";if(!e.lhs&&(s.match("true")||s.match("false")))return"atom";if(!e.lhs&&s.peek()==="[")return e.inArray++,s.next(),"bracket";if(!e.lhs&&s.match(/^\-?\d+(?:\.\d+)?/))return"number";s.eatSpace()||s.next()}return null},languageData:{commentTokens:{line:"#"}}};var Fl=class{constructor(e,t,i){this.from=e,this.to=t,this.diagnostic=i}},Es=class s{constructor(e,t,i){this.diagnostics=e,this.panel=t,this.selected=i}static init(e,t,i){let n=i.facet($o).markerFilter;n&&(e=n(e,i));let r=e.slice().sort((d,m)=>d.from-m.from||d.to-m.to),o=new xi,a=[],l=0,c=i.doc.iter(),h=0,u=i.doc.length;for(let d=0;;){let m=d==r.length?null:r[d];if(!m&&!a.length)break;let g,y;if(a.length)g=l,y=a.reduce((A,T)=>Math.min(A,T.to),m&&m.from>g?m.from:1e8);else{if(g=m.from,g>u)break;y=m.to,a.push(m),d++}for(;d<r.length;){let A=r[d];if(A.from==g&&(A.to>A.from||A.to==g))a.push(A),d++,y=Math.min(A.to,y);else{y=Math.min(A.from,y);break}}y=Math.min(y,u);let _=!1;if(a.some(A=>A.from==g&&(A.to==y||y==u))&&(_=g==y,!_&&y-g<10)){let A=g-(h+c.value.length);A>0&&(c.next(A),h=g);for(let T=g;;){if(T>=y){_=!0;break}if(!c.lineBreak&&h+c.value.length>T)break;T=h+c.value.length,h+=c.value.length,c.next()}}let w=Yx(a);if(_)o.add(g,g,oe.widget({widget:new Ff(w),diagnostics:a.slice()}));else{let A=a.reduce((T,C)=>C.markClass?T+" "+C.markClass:T,"");o.add(g,y,oe.mark({class:"cm-lintRange cm-lintRange-"+w+A,diagnostics:a.slice(),inclusiveEnd:a.some(T=>T.to>y)}))}if(l=y,l==u)break;for(let A=0;A<a.length;A++)a[A].to<=l&&a.splice(A--,1)}let f=o.finish();return new s(f,t,kr(f))}};function kr(s,e=null,t=0){let i=null;return s.between(t,1e9,(n,r,{spec:o})=>{if(!(e&&o.diagnostics.indexOf(e)<0))if(!i)i=new Fl(n,r,e||o.diagnostics[0]);else{if(o.diagnostics.indexOf(i.diagnostic)<0)return!1;i=new Fl(i.from,r,i.diagnostic)}}),i}function Vx(s,e){let t=e.pos,i=e.end||t,n=s.state.facet($o).hideOn(s,t,i);if(n!=null)return n;let r=s.startState.doc.lineAt(e.pos);return!!(s.effects.some(o=>o.is(Vl))||s.changes.touchesRange(r.from,Math.max(r.to,i)))}function u1(s,e){return s.field(Gi,!1)?e:e.concat(de.appendConfig.of(S1))}function Hx(s,e){return{effects:u1(s,[Vl.of(e)])}}var Vl=de.define(),Gx=de.define(),Wx=de.define(),Gi=ot.define({create(){return new Es(oe.none,null,null)},update(s,e){if(e.docChanged&&s.diagnostics.size){let t=s.diagnostics.map(e.changes),i=null,n=s.panel;if(s.selected){let r=e.changes.mapPos(s.selected.from,1);i=kr(t,s.selected.diagnostic,r)||kr(t,null,r)}!t.size&&n&&e.state.facet($o).autoPanel&&(n=null),s=new Es(t,n,i)}for(let t of e.effects)if(t.is(Vl)){let i=e.state.facet($o).autoPanel?t.value.length?Ul.open:null:s.panel;s=Es.init(t.value,i,e.state)}else t.is(Gx)?s=new Es(s.diagnostics,t.value?Ul.open:null,s.selected):t.is(Wx)&&(s=new Es(s.diagnostics,s.panel,t.value));return s},provide:s=>[bs.from(s,e=>e.panel),ee.decorations.from(s,e=>e.diagnostics)]});var f1=oe.mark({class:"cm-lintRange cm-lintRange-active"});function d1(s,e,t){let{diagnostics:i}=s.state.field(Gi),n,r=-1,o=-1;i.between(e-(t<0?1:0),e+(t>0?1:0),(l,c,{spec:h})=>{if(e>=l&&e<=c&&(l==c||(e>l||t>0)&&(e<c||t<0)))return n=h.diagnostics,r=l,o=c,!1});let a=s.state.facet($o).tooltipFilter;return n&&a&&(n=a(n,s.state)),n?{pos:r,end:o,above:!0,create(){return{dom:qx(s,n)}}}:null}function qx(s,e){return Ae("ul",{class:"cm-tooltip-lint"},e.map(t=>$x(s,t,!1)))}var Ux=s=>{let e=s.state.field(Gi,!1);return!e||!e.panel?!1:(s.dispatch({effects:Gx.of(!1)}),!0)};var $o=$.define({combine(s){return{sources:s.map(e=>e.source).filter(e=>e!=null),...vi(s.map(e=>e.config),{delay:750,markerFilter:null,tooltipFilter:null,needsRefresh:null,hideOn:()=>null},{delay:Math.max,markerFilter:zx,tooltipFilter:zx,needsRefresh:(e,t)=>e?t?i=>e(i)||t(i):e:t,hideOn:(e,t)=>e?t?(i,n,r)=>e(i,n,r)||t(i,n,r):e:t,autoPanel:(e,t)=>e||t})}}});function zx(s,e){return s?e?(t,i)=>e(s(t,i),i):s:e}function Xx(s){let e=[];if(s)e:for(let{name:t}of s){for(let i=0;i<t.length;i++){let n=t[i];if(/[a-zA-Z]/.test(n)&&!e.some(r=>r.toLowerCase()==n.toLowerCase())){e.push(n);continue e}}e.push("")}return e}function $x(s,e,t){var i;let n=t?Xx(e.actions):[];return Ae("li",{class:"cm-diagnostic cm-diagnostic-"+e.severity},Ae("span",{class:"cm-diagnosticText"},e.renderMessage?e.renderMessage(s):e.message),(i=e.actions)===null||i===void 0?void 0:i.map((r,o)=>{let a=0,l=d=>{if(d.preventDefault(),a>Date.now()-100)return;let m=kr(s.state.field(Gi).diagnostics,e);m&&r.apply(s,m.from,m.to),a=Date.now()},{name:c}=r,h=n[o]?c.indexOf(n[o]):-1,u=h<0?c:[c.slice(0,h),Ae("u",c.slice(h,h+1)),c.slice(h+1)],f=r.markClass?" "+r.markClass:"";return Ae("button",{type:"button",class:"cm-diagnosticAction"+f,onclick:l,onmousedown:l,"aria-label":` Action: ${c}${h<0?"":` (access key "${n[o]})"`}.`},u)}),e.source&&Ae("div",{class:"cm-diagnosticSource"},e.source))}var Ff=class extends yn{constructor(e){super(),this.sev=e}eq(e){return e.sev==this.sev}toDOM(){return Ae("span",{class:"cm-lintPoint cm-lintPoint-"+this.sev})}},Bl=class{constructor(e,t){this.diagnostic=t,this.id="item_"+Math.floor(Math.random()*4294967295).toString(16),this.dom=$x(e,t,!0),this.dom.id=this.id,this.dom.setAttribute("role","option")}},Ul=class s{constructor(e){this.view=e,this.items=[];let t=n=>{if(!(n.ctrlKey||n.altKey||n.metaKey)){if(n.keyCode==27)Ux(this.view),this.view.focus();else if(n.keyCode==38||n.keyCode==33)this.moveSelection((this.selectedIndex-1+this.items.length)%this.items.length);else if(n.keyCode==40||n.keyCode==34)this.moveSelection((this.selectedIndex+1)%this.items.length);else if(n.keyCode==36)this.moveSelection(0);else if(n.keyCode==35)this.moveSelection(this.items.length-1);else if(n.keyCode==13)this.view.focus();else if(n.keyCode>=65&&n.keyCode<=90&&this.selectedIndex>=0){let{diagnostic:r}=this.items[this.selectedIndex],o=Xx(r.actions);for(let a=0;a<o.length;a++)if(o[a].toUpperCase().charCodeAt(0)==n.keyCode){let l=kr(this.view.state.field(Gi).diagnostics,r);l&&r.actions[a].apply(e,l.from,l.to)}}else return;n.preventDefault()}},i=n=>{for(let r=0;r<this.items.length;r++)this.items[r].dom.contains(n.target)&&this.moveSelection(r)};this.list=Ae("ul",{tabIndex:0,role:"listbox","aria-label":this.view.state.phrase("Diagnostics"),onkeydown:t,onclick:i}),this.dom=Ae("div",{class:"cm-panel-lint"},this.list,Ae("button",{type:"button",name:"close","aria-label":this.view.state.phrase("close"),onclick:()=>Ux(this.view)},"×")),this.update()}get selectedIndex(){let e=this.view.state.field(Gi).selected;if(!e)return-1;for(let t=0;t<this.items.length;t++)if(this.items[t].diagnostic==e.diagnostic)return t;return-1}update(){let{diagnostics:e,selected:t}=this.view.state.field(Gi),i=0,n=!1,r=null,o=new Set;for(e.between(0,this.view.state.doc.length,(a,l,{spec:c})=>{for(let h of c.diagnostics){if(o.has(h))continue;o.add(h);let u=-1,f;for(let d=i;d<this.items.length;d++)if(this.items[d].diagnostic==h){u=d;break}u<0?(f=new Bl(this.view,h),this.items.splice(i,0,f),n=!0):(f=this.items[u],u>i&&(this.items.splice(i,u-i),n=!0)),t&&f.diagnostic==t.diagnostic?f.dom.hasAttribute("aria-selected")||(f.dom.setAttribute("aria-selected","true"),r=f):f.dom.hasAttribute("aria-selected")&&f.dom.removeAttribute("aria-selected"),i++}});i<this.items.length&&!(this.items.length==1&&this.items[0].diagnostic.from<0);)n=!0,this.items.pop();this.items.length==0&&(this.items.push(new Bl(this.view,{from:-1,to:-1,severity:"info",message:this.view.state.phrase("No diagnostics")})),n=!0),r?(this.list.setAttribute("aria-activedescendant",r.id),this.view.requestMeasure({key:this,read:()=>({sel:r.dom.getBoundingClientRect(),panel:this.list.getBoundingClientRect()}),write:({sel:a,panel:l})=>{let c=l.height/this.list.offsetHeight;a.top<l.top?this.list.scrollTop-=(l.top-a.top)/c:a.bottom>l.bottom&&(this.list.scrollTop+=(a.bottom-l.bottom)/c)}})):this.selectedIndex<0&&this.list.removeAttribute("aria-activedescendant"),n&&this.sync()}sync(){let e=this.list.firstChild;function t(){let i=e;e=i.nextSibling,i.remove()}for(let i of this.items)if(i.dom.parentNode==this.list){for(;e!=i.dom;)t();e=i.dom.nextSibling}else this.list.insertBefore(i.dom,e);for(;e;)t()}moveSelection(e){if(this.selectedIndex<0)return;let t=this.view.state.field(Gi),i=kr(t.diagnostics,this.items[e].diagnostic);i&&this.view.dispatch({selection:{anchor:i.from,head:i.to},scrollIntoView:!0,effects:Wx.of(i)})}static open(e){return new s(e)}};function Ol(s,e='viewBox="0 0 40 40"'){return`url('data:image/svg+xml,<svg xmlns="http://www.w3.org/2000/svg" ${e}>${encodeURIComponent(s)}</svg>')`}function Nl(s){return Ol(`<path d="m0 2.5 l2 -1.5 l1 0 l2 1.5 l1 0" stroke="${s}" fill="none" stroke-width=".7"/>`,'width="6" height="3"')}var p1=ee.baseTheme({".cm-diagnostic":{padding:"3px 6px 3px 8px",marginLeft:"-1px",display:"block",whiteSpace:"pre-wrap"},".cm-diagnostic-error":{borderLeft:"5px solid #d11"},".cm-diagnostic-warning":{borderLeft:"5px solid orange"},".cm-diagnostic-info":{borderLeft:"5px solid #999"},".cm-diagnostic-hint":{borderLeft:"5px solid #66d"},".cm-diagnosticAction":{font:"inherit",border:"none",padding:"2px 4px",backgroundColor:"#444",color:"white",borderRadius:"3px",marginLeft:"8px",cursor:"pointer"},".cm-diagnosticSource":{fontSize:"70%",opacity:.7},".cm-lintRange":{backgroundPosition:"left bottom",backgroundRepeat:"repeat-x",paddingBottom:"0.7px"},".cm-lintRange-error":{backgroundImage:Nl("#f11")},".cm-lintRange-warning":{backgroundImage:Nl("orange")},".cm-lintRange-info":{backgroundImage:Nl("#999")},".cm-lintRange-hint":{backgroundImage:Nl("#66d")},".cm-lintRange-active":{backgroundColor:"#ffdd9980"},".cm-tooltip-lint":{padding:0,margin:0},".cm-lintPoint":{position:"relative","&:after":{content:'""',position:"absolute",bottom:0,left:"-2px",borderLeft:"3px solid transparent",borderRight:"3px solid transparent",borderBottom:"4px solid #d11"}},".cm-lintPoint-warning":{"&:after":{borderBottomColor:"orange"}},".cm-lintPoint-info":{"&:after":{borderBottomColor:"#999"}},".cm-lintPoint-hint":{"&:after":{borderBottomColor:"#66d"}},".cm-panel.cm-panel-lint":{position:"relative","& ul":{maxHeight:"100px",overflowY:"auto","& [aria-selected]":{backgroundColor:"#ddd","& u":{textDecoration:"underline"}},"&:focus [aria-selected]":{background_fallback:"#bdf",backgroundColor:"Highlight",color_fallback:"white",color:"HighlightText"},"& u":{textDecoration:"none"},padding:0,margin:0},"& [name=close]":{position:"absolute",top:"0",right:"2px",background:"inherit",border:"none",font:"inherit",padding:0,margin:0}},"&dark .cm-lintRange-active":{backgroundColor:"#86714a80"},"&dark .cm-panel.cm-panel-lint ul":{"& [aria-selected]":{backgroundColor:"#2e343e"}}});function m1(s){return s=="error"?4:s=="warning"?3:s=="info"?2:1}function Yx(s){let e="hint",t=1;for(let i of s){let n=m1(i.severity);n>t&&(t=n,e=i.severity)}return e}var zl=class extends wi{constructor(e){super(),this.diagnostics=e,this.severity=Yx(e)}toDOM(e){let t=document.createElement("div");t.className="cm-lint-marker cm-lint-marker-"+this.severity;let i=this.diagnostics,n=e.state.facet(Hl).tooltipFilter;return n&&(i=n(i,e.state)),i.length&&(t.onmouseover=()=>x1(e,t,i)),t}};function g1(s,e){let t=i=>{let n=e.getBoundingClientRect();if(!(i.clientX>n.left-10&&i.clientX<n.right+10&&i.clientY>n.top-10&&i.clientY<n.bottom+10)){for(let r=i.target;r;r=r.parentNode)if(r.nodeType==1&&r.classList.contains("cm-tooltip-lint"))return;window.removeEventListener("mousemove",t),s.state.field(Kx)&&s.dispatch({effects:Uf.of(null)})}};window.addEventListener("mousemove",t)}function x1(s,e,t){function i(){let o=s.elementAtHeight(e.getBoundingClientRect().top+5-s.documentTop);s.coordsAtPos(o.from)&&s.dispatch({effects:Uf.of({pos:o.from,above:!1,clip:!1,create(){return{dom:qx(s,t),getCoords:()=>e.getBoundingClientRect()}}})}),e.onmouseout=e.onmousemove=null,g1(s,e)}let{hoverTime:n}=s.state.facet(Hl),r=setTimeout(i,n);e.onmouseout=()=>{clearTimeout(r),e.onmouseout=e.onmousemove=null},e.onmousemove=()=>{clearTimeout(r),r=setTimeout(i,n)}}function v1(s,e){let t=Object.create(null);for(let n of e){let r=s.lineAt(n.from);(t[r.from]||(t[r.from]=[])).push(n)}let i=[];for(let n in t)i.push(new zl(t[n]).range(+n));return Me.of(i,!0)}var y1=sf({class:"cm-gutter-lint",markers:s=>s.state.field(Bf),widgetMarker:(s,e,t)=>{let i=[];return s.state.field(Bf).between(t.from,t.to,(n,r,o)=>{n>t.from&&n<t.to&&i.push(...o.diagnostics)}),i.length?new zl(i):null}}),Bf=ot.define({create(){return Me.empty},update(s,e){s=s.map(e.changes);let t=e.state.facet(Hl).markerFilter;for(let i of e.effects)if(i.is(Vl)){let n=i.value;t&&(n=t(n||[],e.state)),s=v1(e.state.doc,n.slice(0))}return s}}),Uf=de.define(),Kx=ot.define({create(){return null},update(s,e){return s&&e.docChanged&&(s=Vx(e,s)?null:{...s,pos:e.changes.mapPos(s.pos)}),e.effects.reduce((t,i)=>i.is(Uf)?i.value:t,s)},provide:s=>vl.from(s)}),b1=ee.baseTheme({".cm-gutter-lint":{width:"1.4em","& .cm-gutterElement":{padding:".2em"}},".cm-lint-marker":{width:"1em",height:"1em"},".cm-lint-marker-info":{content:Ol('<path fill="#aaf" stroke="#77e" stroke-width="6" stroke-linejoin="round" d="M5 5L35 5L35 35L5 35Z"/>')},".cm-lint-marker-warning":{content:Ol('<path fill="#fe8" stroke="#fd7" stroke-width="6" stroke-linejoin="round" d="M20 6L37 35L3 35Z"/>')},".cm-lint-marker-error":{content:Ol('<circle cx="20" cy="20" r="15" fill="#f87" stroke="#f43" stroke-width="6"/>')}}),_1=p0(d1,{hideOn:Vx}),S1=[Gi,ee.decorations.compute([Gi],s=>{let{selected:e,panel:t}=s.field(Gi);return!e||!t||e.from==e.to?oe.none:oe.set([f1.range(e.from,e.to)])}),_1,p1],Hl=$.define({combine(s){return vi(s,{hoverTime:300,markerFilter:null,tooltipFilter:null})}});function Jx(s={}){return[Hl.of(s),Bf,y1,b1,Kx]}var Zx=typeof String.prototype.normalize=="function"?s=>s.normalize("NFKD"):s=>s,qn=class{constructor(e,t,i=0,n=e.length,r,o){this.test=o,this.value={from:0,to:0,precise:!1},this.done=!1,this.matches=[],this.buffer="",this.bufferPos=0,this.iter=e.iterRange(i,n),this.bufferStart=i,this.normalize=r?a=>r(Zx(a)):Zx,this.query=this.normalize(t)}peek(){if(this.bufferPos==this.buffer.length){if(this.bufferStart+=this.buffer.length,this.iter.next(),this.iter.done)return-1;this.bufferPos=0,this.buffer=this.iter.value}return Oa(this.buffer,this.bufferPos)}next(){for(;this.matches.length;)this.matches.pop();return this.nextOverlapping()}nextOverlapping(){for(;;){let e=this.peek();if(e<0)return this.done=!0,this;let t=pm(e),i=this.bufferStart+this.bufferPos;this.bufferPos+=Fa(e);let n=this.normalize(t);if(n.length)for(let r=0,o=i,a=!0;;r++){let l=n.charCodeAt(r),c=this.match(l,o,a,this.bufferPos+this.bufferStart,r==n.length-1);if(c)return this.value=c,this;if(r==n.length-1)break;a&&r<t.length&&t.charCodeAt(r)==l?o++:a=!1}}}match(e,t,i,n,r){let o=null;for(let a=0;a<this.matches.length;){let l=this.matches[a],c=!1;this.query.charCodeAt(l.index)==e&&(l.index==this.query.length-1?o={from:l.from,to:n,precise:r&&l.precise}:(l.index++,c=!0)),c?a++:this.matches.splice(a,1)}return this.query.charCodeAt(0)==e&&(this.query.length==1?o={from:t,to:n,precise:i&&r}:this.matches.push({from:t,index:1,precise:i})),o&&this.test&&!this.test(o.from,o.to,this.buffer,this.bufferStart)&&(o=null),o}};typeof Symbol<"u"&&(qn.prototype[Symbol.iterator]=function(){return this});var ev={from:-1,to:-1,match:/.*/.exec(""),precise:!0},Xf="gm"+(/x/.unicode==null?"":"u"),ql=class{constructor(e,t,i,n=0,r=e.length){if(this.text=e,this.to=r,this.curLine="",this.done=!1,this.value=ev,/\\[sWDnr]|\n|\r|\[\^/.test(t))return new $l(e,t,i,n,r);this.re=new RegExp(t,Xf+(i?.ignoreCase?"i":"")),this.test=i?.test,this.iter=e.iter();let o=e.lineAt(n);this.curLineStart=o.from,this.matchPos=Yl(e,n),this.getLine(this.curLineStart)}getLine(e){this.iter.next(e),this.iter.lineBreak?this.curLine="":(this.curLine=this.iter.value,this.curLineStart+this.curLine.length>this.to&&(this.curLine=this.curLine.slice(0,this.to-this.curLineStart)),this.iter.next())}nextLine(){this.curLineStart=this.curLineStart+this.curLine.length+1,this.curLineStart>this.to?this.curLine="":this.getLine(0)}next(){for(let e=this.matchPos-this.curLineStart;;){this.re.lastIndex=e;let t=this.matchPos<=this.to&&this.re.exec(this.curLine);if(t){let i=this.curLineStart+t.index,n=i+t[0].length;if(this.matchPos=Yl(this.text,n+(i==n?1:0)),i==this.curLineStart+this.curLine.length&&this.nextLine(),(i<n||i>this.value.to)&&(!this.test||this.test(i,n,t)))return this.value={from:i,to:n,precise:!0,match:t},this;e=this.matchPos-this.curLineStart}else if(this.curLineStart+this.curLine.length<this.to)this.nextLine(),e=0;else return this.done=!0,this}}},zf=new WeakMap,Xl=class s{constructor(e,t){this.from=e,this.text=t}get to(){return this.from+this.text.length}static get(e,t,i){let n=zf.get(e);if(!n||n.from>=i||n.to<=t){let a=new s(t,e.sliceString(t,i));return zf.set(e,a),a}if(n.from==t&&n.to==i)return n;let{text:r,from:o}=n;return o>t&&(r=e.sliceString(t,o)+r,o=t),n.to<i&&(r+=e.sliceString(n.to,i)),zf.set(e,new s(o,r)),new s(t,r.slice(t-o,i-o))}},$l=class{constructor(e,t,i,n,r){this.text=e,this.to=r,this.done=!1,this.value=ev,this.matchPos=Yl(e,n),this.re=new RegExp(t,Xf+(i?.ignoreCase?"i":"")),this.test=i?.test,this.flat=Xl.get(e,n,this.chunkEnd(n+5e3))}chunkEnd(e){return e>=this.to?this.to:this.text.lineAt(e).to}next(){for(;;){let e=this.re.lastIndex=this.matchPos-this.flat.from,t=this.re.exec(this.flat.text);if(t&&!t[0]&&t.index==e&&(this.re.lastIndex=e+1,t=this.re.exec(this.flat.text)),t){let i=this.flat.from+t.index,n=i+t[0].length;if((this.flat.to>=this.to||t.index+t[0].length<=this.flat.text.length-10)&&(!this.test||this.test(i,n,t)))return this.value={from:i,to:n,precise:!0,match:t},this.matchPos=Yl(this.text,n+(i==n?1:0)),this}if(this.flat.to==this.to)return this.done=!0,this;this.flat=Xl.get(this.text,this.flat.from,this.chunkEnd(this.flat.from+this.flat.text.length*2))}}};typeof Symbol<"u"&&(ql.prototype[Symbol.iterator]=$l.prototype[Symbol.iterator]=function(){return this});function w1(s){try{return new RegExp(s,Xf),!0}catch{return!1}}function Yl(s,e){if(e>=s.length)return e;let t=s.lineAt(e),i;for(;e<t.to&&(i=t.text.charCodeAt(e-t.from))>=56320&&i<57344;)e++;return e}var M1=s=>{let e=x0(s,"cm-goto-line");if(e){let o=e.dom.querySelector("input[type=text]");return o&&o.select(),!0}let{state:t}=s,i=String(t.doc.lineAt(s.state.selection.main.head).number),{close:n,result:r}=g0(s,{class:"cm-goto-line",label:t.phrase("Go to line"),input:{type:"text",name:"line",value:i},focus:!0,submitLabel:t.phrase("go")});return r.then(o=>{let a=o&&/^([+-])?(\d+)?(:\d+)?(%)?$/.exec(o.elements.line.value);if(!a){s.dispatch({effects:n});return}let l=t.doc.lineAt(t.selection.main.head),[,c,h,u,f]=a,d=u?+u.slice(1):0,m=h?+h:l.number;if(h&&f){let _=m/100;c&&(_=_*(c=="-"?-1:1)+l.number/t.doc.lines),m=Math.round(t.doc.lines*_)}else h&&c&&(m=m*(c=="-"?-1:1)+l.number);let g=t.doc.line(Math.max(1,Math.min(t.doc.lines,m))),y=I.cursor(g.from+Math.max(0,Math.min(d,g.length)));s.dispatch({effects:[n,ee.scrollIntoView(y.from,{y:"center"})],selection:y})}),!0},A1={highlightWordAroundCursor:!1,minSelectionLength:1,maxMatches:100,wholeWords:!1},tv=$.define({combine(s){return vi(s,A1,{highlightWordAroundCursor:(e,t)=>e||t,minSelectionLength:Math.min,maxMatches:Math.min})}});function iv(s){let e=[P1,R1];return s&&e.push(tv.of(s)),e}var T1=oe.mark({class:"cm-selectionMatch"}),E1=oe.mark({class:"cm-selectionMatch cm-selectionMatch-main"});function jx(s,e,t,i){return(t==0||s(e.sliceDoc(t-1,t))!=Ye.Word)&&(i==e.doc.length||s(e.sliceDoc(i,i+1))!=Ye.Word)}function C1(s,e,t,i){return s(e.sliceDoc(t,t+1))==Ye.Word&&s(e.sliceDoc(i-1,i))==Ye.Word}var R1=_t.fromClass(class{constructor(s){this.decorations=this.getDeco(s)}update(s){(s.selectionSet||s.docChanged||s.viewportChanged)&&(this.decorations=this.getDeco(s.view))}getDeco(s){let e=s.state.facet(tv),{state:t}=s,i=t.selection;if(i.ranges.length>1)return oe.none;let n=i.main,r,o=null;if(n.empty){if(!e.highlightWordAroundCursor)return oe.none;let l=t.wordAt(n.head);if(!l)return oe.none;o=t.charCategorizer(n.head),r=t.sliceDoc(l.from,l.to)}else{let l=n.to-n.from;if(l<e.minSelectionLength||l>200)return oe.none;if(e.wholeWords){if(r=t.sliceDoc(n.from,n.to),o=t.charCategorizer(n.head),!(jx(o,t,n.from,n.to)&&C1(o,t,n.from,n.to)))return oe.none}else if(r=t.sliceDoc(n.from,n.to),!r)return oe.none}let a=[];for(let l of s.visibleRanges){let c=new qn(t.doc,r,l.from,l.to);for(;!c.next().done;){let{from:h,to:u}=c.value;if((!o||jx(o,t,h,u))&&(n.empty&&h<=n.from&&u>=n.to?a.push(E1.range(h,u)):(h>=n.to||u<=n.from)&&a.push(T1.range(h,u)),a.length>e.maxMatches))return oe.none}}return oe.set(a)}},{decorations:s=>s.decorations}),P1=ee.baseTheme({".cm-selectionMatch":{backgroundColor:"#99ff7780"},".cm-searchMatch .cm-selectionMatch":{backgroundColor:"transparent"}}),k1=({state:s,dispatch:e})=>{let{selection:t}=s,i=I.create(t.ranges.map(n=>s.wordAt(n.head)||I.cursor(n.head)),t.mainIndex);return i.eq(t)?!1:(e(s.update({selection:i})),!0)};function L1(s,e){let{main:t,ranges:i}=s.selection,n=s.wordAt(t.head),r=n&&n.from==t.from&&n.to==t.to;for(let o=!1,a=new qn(s.doc,e,i[i.length-1].to);;)if(a.next(),a.done){if(o)return null;a=new qn(s.doc,e,0,Math.max(0,i[i.length-1].from-1)),o=!0}else{if(o&&i.some(l=>l.from==a.value.from))continue;if(r){let l=s.wordAt(a.value.from);if(!l||l.from!=a.value.from||l.to!=a.value.to)continue}return a.value}}var I1=({state:s,dispatch:e})=>{let{ranges:t}=s.selection;if(t.some(r=>r.from===r.to))return k1({state:s,dispatch:e});let i=s.sliceDoc(t[0].from,t[0].to);if(s.selection.ranges.some(r=>s.sliceDoc(r.from,r.to)!=i))return!1;let n=L1(s,i);return n?(e(s.update({selection:s.selection.addRange(I.range(n.from,n.to),!1),effects:ee.scrollIntoView(n.to)})),!0):!1},Cs=$.define({combine(s){return vi(s,{top:!1,caseSensitive:!1,literal:!1,regexp:!1,wholeWord:!1,createPanel:e=>new Wf(e),scrollToMatch:e=>ee.scrollIntoView(e)})}});function nv(s){return s?[Cs.of(s),qf]:qf}var Kl=class{constructor(e){this.search=e.search,this.caseSensitive=!!e.caseSensitive,this.literal=!!e.literal,this.regexp=!!e.regexp,this.replace=e.replace||"",this.valid=!!this.search&&(!this.regexp||w1(this.search)),this.unquoted=this.unquote(this.search),this.wholeWord=!!e.wholeWord,this.test=e.test}unquote(e){return this.literal?e:e.replace(/\\([nrt\\])/g,(t,i)=>i=="n"?`
`:i=="r"?"\r":i=="t"?"	":"\\")}eq(e){return this.search==e.search&&this.replace==e.replace&&this.caseSensitive==e.caseSensitive&&this.regexp==e.regexp&&this.wholeWord==e.wholeWord&&this.test==e.test}create(){return this.regexp?new Hf(this):new Vf(this)}getCursor(e,t=0,i){let n=e.doc?e:Ue.create({doc:e});return i==null&&(i=n.doc.length),this.regexp?Ir(this,n,t,i):Lr(this,n,t,i)}},Jl=class{constructor(e){this.spec=e}};function D1(s,e,t){return(i,n,r,o)=>{if(t&&!t(i,n,r,o))return!1;let a=i>=o&&n<=o+r.length?r.slice(i-o,n-o):e.doc.sliceString(i,n);return s(a,e,i,n)}}function Lr(s,e,t,i){let n;return s.wholeWord&&(n=N1(e.doc,e.charCategorizer(e.selection.main.head))),s.test&&(n=D1(s.test,e,n)),new qn(e.doc,s.unquoted,t,i,s.caseSensitive?void 0:r=>r.toLowerCase(),n)}function N1(s,e){return(t,i,n,r)=>((r>t||r+n.length<i)&&(r=Math.max(0,t-2),n=s.sliceString(r,Math.min(s.length,i+2))),(e(Zl(n,t-r))!=Ye.Word||e(jl(n,t-r))!=Ye.Word)&&(e(jl(n,i-r))!=Ye.Word||e(Zl(n,i-r))!=Ye.Word))}var Vf=class extends Jl{constructor(e){super(e)}nextMatch(e,t,i){let n=Lr(this.spec,e,i,e.doc.length).nextOverlapping();if(n.done){let r=Math.min(e.doc.length,t+this.spec.unquoted.length);n=Lr(this.spec,e,0,r).nextOverlapping()}return n.done||n.value.from==t&&n.value.to==i?null:n.value}prevMatchInRange(e,t,i){for(let n=i;;){let r=Math.max(t,n-1e4-this.spec.unquoted.length),o=Lr(this.spec,e,r,n),a=null;for(;!o.nextOverlapping().done;)a=o.value;if(a)return a;if(r==t)return null;n-=1e4}}prevMatch(e,t,i){let n=this.prevMatchInRange(e,0,t);return n||(n=this.prevMatchInRange(e,Math.max(0,i-this.spec.unquoted.length),e.doc.length)),n&&(n.from!=t||n.to!=i)?n:null}getReplacement(e){return this.spec.unquote(this.spec.replace)}matchAll(e,t){let i=Lr(this.spec,e,0,e.doc.length),n=[];for(;!i.next().done;){if(n.length>=t)return null;n.push(i.value)}return n}highlight(e,t,i,n){let r=Lr(this.spec,e,Math.max(0,t-this.spec.unquoted.length),Math.min(i+this.spec.unquoted.length,e.doc.length));for(;!r.next().done;)n(r.value.from,r.value.to)}};function O1(s,e,t){return(i,n,r)=>(!t||t(i,n,r))&&s(r[0],e,i,n)}function Ir(s,e,t,i){let n;return s.wholeWord&&(n=F1(e.charCategorizer(e.selection.main.head))),s.test&&(n=O1(s.test,e,n)),new ql(e.doc,s.search,{ignoreCase:!s.caseSensitive,test:n},t,i)}function Zl(s,e){return s.slice(nt(s,e,!1),e)}function jl(s,e){return s.slice(e,nt(s,e))}function F1(s){return(e,t,i)=>!i[0].length||(s(Zl(i.input,i.index))!=Ye.Word||s(jl(i.input,i.index))!=Ye.Word)&&(s(jl(i.input,i.index+i[0].length))!=Ye.Word||s(Zl(i.input,i.index+i[0].length))!=Ye.Word)}var Hf=class extends Jl{nextMatch(e,t,i){let n=Ir(this.spec,e,i,e.doc.length).next();return n.done&&(n=Ir(this.spec,e,0,t).next()),n.done?null:n.value}prevMatchInRange(e,t,i){for(let n=1;;n++){let r=Math.max(t,i-n*1e4),o=Ir(this.spec,e,r,i),a=null;for(;!o.next().done;)a=o.value;if(a&&(r==t||a.from>r+10))return a;if(r==t)return null}}prevMatch(e,t,i){return this.prevMatchInRange(e,0,t)||this.prevMatchInRange(e,i,e.doc.length)}getReplacement(e){return this.spec.unquote(this.spec.replace).replace(/\$([$&]|\d+)/g,(t,i)=>{if(i=="&")return e.match[0];if(i=="$")return"$";for(let n=i.length;n>0;n--){let r=+i.slice(0,n);if(r>0&&r<e.match.length)return e.match[r]+i.slice(n)}return t})}matchAll(e,t){let i=Ir(this.spec,e,0,e.doc.length),n=[];for(;!i.next().done;){if(n.length>=t)return null;n.push(i.value)}return n}highlight(e,t,i,n){let r=Ir(this.spec,e,Math.max(0,t-250),Math.min(i+250,e.doc.length));for(;!r.next().done;)n(r.value.from,r.value.to)}},Ko=de.define(),$f=de.define(),Wn=ot.define({create(s){return new Yo(Gf(s).create(),null)},update(s,e){for(let t of e.effects)t.is(Ko)?s=new Yo(t.value.create(),s.panel):t.is($f)&&(s=new Yo(s.query,t.value?Yf:null));return s},provide:s=>bs.from(s,e=>e.panel)});var Yo=class{constructor(e,t){this.query=e,this.panel=t}},B1=oe.mark({class:"cm-searchMatch"}),U1=oe.mark({class:"cm-searchMatch cm-searchMatch-selected"}),z1=_t.fromClass(class{constructor(s){this.view=s,this.decorations=this.highlight(s.state.field(Wn))}update(s){let e=s.state.field(Wn);(e!=s.startState.field(Wn)||s.docChanged||s.selectionSet||s.viewportChanged)&&(this.decorations=this.highlight(e))}highlight({query:s,panel:e}){if(!e||!s.spec.valid)return oe.none;let{view:t}=this,i=new xi;for(let n=0,r=t.visibleRanges,o=r.length;n<o;n++){let{from:a,to:l}=r[n];for(;n<o-1&&l>r[n+1].from-500;)l=r[++n].to;s.highlight(t.state,a,l,(c,h)=>{let u=t.state.selection.ranges.some(f=>f.from==c&&f.to==h);i.add(c,h,u?U1:B1)})}return i.finish()}},{decorations:s=>s.decorations});function Jo(s){return e=>{let t=e.state.field(Wn,!1);return t&&t.query.spec.valid?s(e,t):ov(e)}}var Ql=Jo((s,{query:e})=>{let{to:t}=s.state.selection.main,i=e.nextMatch(s.state,t,t);if(!i)return!1;let n=I.single(i.from,i.to),r=s.state.facet(Cs);return s.dispatch({selection:n,effects:[Kf(s,i),r.scrollToMatch(n.main,s)],userEvent:"select.search"}),rv(s),!0}),ec=Jo((s,{query:e})=>{let{state:t}=s,{from:i}=t.selection.main,n=e.prevMatch(t,i,i);if(!n)return!1;let r=I.single(n.from,n.to),o=s.state.facet(Cs);return s.dispatch({selection:r,effects:[Kf(s,n),o.scrollToMatch(r.main,s)],userEvent:"select.search"}),rv(s),!0}),V1=Jo((s,{query:e})=>{let t=e.matchAll(s.state,1e3);return!t||!t.length?!1:(s.dispatch({selection:I.create(t.map(i=>I.range(i.from,i.to))),userEvent:"select.search.matches"}),!0)}),H1=({state:s,dispatch:e})=>{let t=s.selection;if(t.ranges.length>1||t.main.empty)return!1;let{from:i,to:n}=t.main,r=[],o=0;for(let a=new qn(s.doc,s.sliceDoc(i,n));!a.next().done;){if(r.length>1e3)return!1;a.value.from==i&&(o=r.length),r.push(I.range(a.value.from,a.value.to))}return e(s.update({selection:I.create(r,o),userEvent:"select.search.matches"})),!0},Qx=Jo((s,{query:e})=>{let{state:t}=s,{from:i,to:n}=t.selection.main;if(t.readOnly)return!1;let r=e.nextMatch(t,i,i);if(!r)return!1;let o=r,a=[],l,c,h=[];o.precise?o.from==i&&o.to==n&&(c=t.toText(e.getReplacement(o)),a.push({from:o.from,to:o.to,insert:c}),o=e.nextMatch(t,o.from,o.to),h.push(ee.announce.of(t.phrase("replaced match on line $",t.doc.lineAt(i).number)+"."))):o=e.nextMatch(t,o.from,o.to);let u=s.state.changes(a);return o&&(l=I.single(o.from,o.to).map(u),h.push(Kf(s,o)),h.push(t.facet(Cs).scrollToMatch(l.main,s))),s.dispatch({changes:u,selection:l,effects:h,userEvent:"input.replace"}),!0}),G1=Jo((s,{query:e})=>{if(s.state.readOnly)return!1;let t=[];for(let n of e.matchAll(s.state,1e9)){let{from:r,to:o,precise:a}=n;a&&t.push({from:r,to:o,insert:e.getReplacement(n)})}if(!t.length)return!1;let i=s.state.phrase("replaced $ matches",t.length)+".";return s.dispatch({changes:t,effects:ee.announce.of(i),userEvent:"input.replace.all"}),!0});function Yf(s){return s.state.facet(Cs).createPanel(s)}function Gf(s,e){var t,i,n,r,o;let a=s.selection.main,l=a.empty||a.to>a.from+100?"":s.sliceDoc(a.from,a.to);if(e&&!l)return e;let c=s.facet(Cs);return new Kl({search:((t=e?.literal)!==null&&t!==void 0?t:c.literal)?l:l.replace(/\n/g,"\\n"),caseSensitive:(i=e?.caseSensitive)!==null&&i!==void 0?i:c.caseSensitive,literal:(n=e?.literal)!==null&&n!==void 0?n:c.literal,regexp:(r=e?.regexp)!==null&&r!==void 0?r:c.regexp,wholeWord:(o=e?.wholeWord)!==null&&o!==void 0?o:c.wholeWord})}function sv(s){let e=Lo(s,Yf);return e&&e.dom.querySelector("[main-field]")}function rv(s){let e=sv(s);e&&e==s.root.activeElement&&e.select()}var ov=s=>{let e=s.state.field(Wn,!1);if(e&&e.panel){let t=sv(s);if(t&&t!=s.root.activeElement){let i=Gf(s.state,e.query.spec);i.valid&&s.dispatch({effects:Ko.of(i)}),t.focus(),t.select()}}else s.dispatch({effects:[$f.of(!0),e?Ko.of(Gf(s.state,e.query.spec)):de.appendConfig.of(qf)]});return!0},av=s=>{let e=s.state.field(Wn,!1);if(!e||!e.panel)return!1;let t=Lo(s,Yf);return t&&t.dom.contains(s.root.activeElement)&&s.focus(),s.dispatch({effects:$f.of(!1)}),!0},lv=[{key:"Mod-f",run:ov,scope:"editor search-panel"},{key:"F3",run:Ql,shift:ec,scope:"editor search-panel",preventDefault:!0},{key:"Mod-g",run:Ql,shift:ec,scope:"editor search-panel",preventDefault:!0},{key:"Escape",run:av,scope:"editor search-panel"},{key:"Mod-Shift-l",run:H1},{key:"Mod-Alt-g",run:M1},{key:"Mod-d",run:I1,preventDefault:!0}],Wf=class{constructor(e){this.view=e;let t=this.query=e.state.field(Wn).query.spec;this.commit=this.commit.bind(this),this.searchField=Ae("input",{value:t.search,placeholder:ri(e,"Find"),"aria-label":ri(e,"Find"),class:"cm-textfield",name:"search",form:"","main-field":"true",onchange:this.commit,onkeyup:this.commit}),this.replaceField=Ae("input",{value:t.replace,placeholder:ri(e,"Replace"),"aria-label":ri(e,"Replace"),class:"cm-textfield",name:"replace",form:"",onchange:this.commit,onkeyup:this.commit}),this.caseField=Ae("input",{type:"checkbox",name:"case",form:"",checked:t.caseSensitive,onchange:this.commit}),this.reField=Ae("input",{type:"checkbox",name:"re",form:"",checked:t.regexp,onchange:this.commit}),this.wordField=Ae("input",{type:"checkbox",name:"word",form:"",checked:t.wholeWord,onchange:this.commit});function i(n,r,o){return Ae("button",{class:"cm-button",name:n,onclick:r,type:"button"},o)}this.dom=Ae("div",{onkeydown:n=>this.keydown(n),class:"cm-search"},[this.searchField,i("next",()=>Ql(e),[ri(e,"next")]),i("prev",()=>ec(e),[ri(e,"previous")]),i("select",()=>V1(e),[ri(e,"all")]),Ae("label",null,[this.caseField,ri(e,"match case")]),Ae("label",null,[this.reField,ri(e,"regexp")]),Ae("label",null,[this.wordField,ri(e,"by word")]),...e.state.readOnly?[]:[Ae("br"),this.replaceField,i("replace",()=>Qx(e),[ri(e,"replace")]),i("replaceAll",()=>G1(e),[ri(e,"replace all")])],Ae("button",{name:"close",onclick:()=>av(e),"aria-label":ri(e,"close"),type:"button"},["×"])])}commit(){let e=new Kl({search:this.searchField.value,caseSensitive:this.caseField.checked,regexp:this.reField.checked,wholeWord:this.wordField.checked,replace:this.replaceField.value});e.eq(this.query)||(this.query=e,this.view.dispatch({effects:Ko.of(e)}))}keydown(e){r0(this.view,e,"search-panel")?e.preventDefault():e.keyCode==13&&e.target==this.searchField?(e.preventDefault(),(e.shiftKey?ec:Ql)(this.view)):e.keyCode==13&&e.target==this.replaceField&&(e.preventDefault(),Qx(this.view))}update(e){for(let t of e.transactions)for(let i of t.effects)i.is(Ko)&&!i.value.eq(this.query)&&this.setQuery(i.value)}setQuery(e){this.query=e,this.searchField.value=e.search,this.replaceField.value=e.replace,this.caseField.checked=e.caseSensitive,this.reField.checked=e.regexp,this.wordField.checked=e.wholeWord}mount(){this.searchField.select()}get pos(){return 80}get top(){return this.view.state.facet(Cs).top}};function ri(s,e){return s.state.phrase(e)}var Gl=30,Wl=/[\s\.,:;?!]/;function Kf(s,{from:e,to:t}){let i=s.state.doc.lineAt(e),n=s.state.doc.lineAt(t).to,r=Math.max(i.from,e-Gl),o=Math.min(n,t+Gl),a=s.state.sliceDoc(r,o);if(r!=i.from){for(let l=0;l<Gl;l++)if(!Wl.test(a[l+1])&&Wl.test(a[l])){a=a.slice(l);break}}if(o!=n){for(let l=a.length-1;l>a.length-Gl;l--)if(!Wl.test(a[l-1])&&Wl.test(a[l])){a=a.slice(0,l);break}}return ee.announce.of(`${s.state.phrase("current match")}. ${a} ${s.state.phrase("on line")} ${i.number}.`)}var W1=ee.baseTheme({".cm-panel.cm-search":{padding:"2px 6px 4px",position:"relative","& [name=close]":{position:"absolute",top:"0",right:"4px",backgroundColor:"inherit",border:"none",font:"inherit",padding:0,margin:0},"& input, & button, & label":{margin:".2em .6em .2em 0"},"& input[type=checkbox]":{marginRight:".2em"},"& label":{fontSize:"80%",whiteSpace:"pre"}},"&light .cm-searchMatch":{backgroundColor:"#ffff0054"},"&dark .cm-searchMatch":{backgroundColor:"#00ffff8a"},"&light .cm-searchMatch-selected":{backgroundColor:"#ff6a0054"},"&dark .cm-searchMatch-selected":{backgroundColor:"#ff00ff8a"}}),qf=[Wn,Dn.low(z1),W1];var q1=150,X1=120,$1=Rr.define([{tag:z.comment,color:"var(--quiet)",fontStyle:"italic"},{tag:z.string,color:"var(--string)"},{tag:[z.number,z.bool,z.atom],color:"var(--literal)"},{tag:[z.propertyName,z.variableName],color:"var(--ink)"},{tag:[z.keyword,z.tagName,z.heading],color:"var(--accent)",fontWeight:"600"}]),Y1=ee.theme({"&":{height:"100%",fontSize:"12px",color:"var(--ink)",backgroundColor:"var(--paper)"},".cm-scroller":{fontFamily:"var(--mono)",lineHeight:"1.45"},".cm-content":{caretColor:"var(--ink)"},".cm-gutters":{backgroundColor:"var(--panel)",color:"var(--quiet)",border:"none"},".cm-activeLine, .cm-activeLineGutter":{backgroundColor:"var(--hover)"},"&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground":{background:"var(--mark) !important"},".cm-lit":{backgroundColor:"var(--mark)"},".cm-lintRange-error":{backgroundImage:"none",textDecoration:"underline wavy var(--poor)"},".cm-lintRange-warning":{backgroundImage:"none",textDecoration:"underline dotted var(--fair)"},".cm-lint-marker":{width:"0.9em",textAlign:"center"},".cm-lint-marker-error":{content:'"●"',color:"var(--poor)"},".cm-lint-marker-warning":{content:'"▲"',color:"var(--fair)"},".cm-tooltip":{backgroundColor:"var(--panel)",color:"var(--ink)",border:"1px solid var(--edge)",maxWidth:"60ch"},".cm-panels":{backgroundColor:"var(--panel)",color:"var(--ink)"},".cm-searchMatch":{backgroundColor:"var(--mark)"}}),cv=de.define(),K1=ot.define({create:()=>oe.none,update(s,e){for(let t of e.effects)if(t.is(cv))return J1(e.state,t.value);return s.map(e.changes)},provide:s=>ee.decorations.from(s)});function J1(s,e){let t=[...new Set(e)].filter(i=>i>=1&&i<=s.doc.lines).sort((i,n)=>i-n);return oe.set(t.map(i=>oe.line({class:"cm-lit"}).range(s.doc.line(i).from)))}var tc=class{constructor(e,t){this.studio=e;this.found=t;let i=S("div",{id:"editor"});K(re("text"),S("div",{className:"bar"},S("h2",{},"Design file"),S("span",{id:"sound",className:"pill"})),i,this.problems);let n=i.attachShadow({mode:"open"});this.view=new ee({parent:n,root:n,state:this.fresh()}),e.state.watch(r=>r&&this.take(r)),e.line.watch(({line:r,focus:o})=>this.goto(r,o))}studio;found;view;problems=S("ul",{id:"problems",ariaLive:"polite"});send=co(q1,()=>this.edit());look=co(X1,()=>this.lookUp());revision=0;isOurs=!0;line=0;fresh(){let e=nf.of([...lv,...Ox,Fx]),t=ee.contentAttributes.of({"aria-label":"design file"}),i=ee.updateListener.of(r=>this.heed(r)),n=[K1,Jx(),_0(),c0(),u0(),$0(),iv(),nv({top:!0})];return Ue.create({extensions:[n,El.define(Bx),G0($1),Y1,e,t,i]})}heed(e){e.transactions.some(i=>i.annotation(ut.remote)!==!0&&i.docChanged)?(this.isOurs=!1,this.send()):e.selectionSet&&!e.docChanged&&this.view.hasFocus&&this.look()}flush(){return this.send.now()}edit(){let e=this.view.state.doc.toString();this.studio.connection.newest("edit",{kind:"edit",text:e,revision:this.revision},t=>{t.kind==="refusal"&&t.stale&&this.differ()})}differ(){let e=S("button",{type:"button",click:()=>(this.edit(),K(this.problems))},"keep mine"),t=S("button",{type:"button",click:()=>(this.isOurs=!0,this.studio.state.value&&this.take(this.studio.state.value))},"take theirs");K(this.problems,S("li",{className:"error"},"Another page changed the text meanwhile. ",e," ",t))}take(e){this.revision=e.revision;let t=this.view.state.doc.toString(),i=!this.isOurs&&e.text!==t;e.text===t&&(this.isOurs=!0),i||this.replace(e.text),this.mark(e)}replace(e){let t=this.view.state.doc.toString();if(e===t)return;let i=Math.min(t.length,e.length),n=0;for(;n<i&&t[n]===e[n];)n+=1;let r=0;for(;r<i-n&&t[t.length-1-r]===e[e.length-1-r];)r+=1;let o={from:n,to:t.length-r,insert:e.slice(n,e.length-r)};this.view.dispatch({changes:o,annotations:ut.remote.of(!0)})}mark(e){let t=[...e.problems.map(n=>[n,"error"]),...e.cautions.map(n=>[n,"warning"])];this.view.dispatch(Hx(this.view.state,t.filter(([n])=>n.line!==null).map(([n,r])=>this.diagnostic(n,r)))),K(this.problems,...t.map(([n,r])=>this.item(n,r)));let i=re("sound");i.className=e.sound?"pill good":"pill poor",K(i,e.sound?"sound":`${e.problems.length} to mend; figures are the last sound design's`),document.body.classList.toggle("unsound",!e.sound)}diagnostic(e,t){let{doc:i}=this.view.state,n=i.line(Math.max(1,Math.min(e.line??1,i.lines)));return{from:e.column?Math.min(n.from+e.column-1,n.to):n.from+(n.text.length-n.text.trimStart().length),to:n.to,severity:t,message:`${e.what} ${e.advice}`.trim()}}item(e,t){let i=e.line===null?e.where:`line ${e.line}: ${e.where}`;return S("li",{className:t},S("button",{type:"button",disabled:e.line===null,click:()=>this.goto(e.line??0,!0)},i),` ${e.what} ${e.advice}`)}lighten(e){this.view.dispatch({effects:cv.of(e)}),e[0]&&this.goto(e[0],!1)}goto(e,t){let{doc:i}=this.view.state;if(e<1||e>i.lines)return;let{from:n}=i.line(e);this.line=e,this.view.dispatch({selection:{anchor:n},effects:ee.scrollIntoView(n,{y:"center"}),annotations:ut.remote.of(!0)}),t&&this.view.focus()}async lookUp(){let e=this.view.state.doc.lineAt(this.view.state.selection.main.head).number;if(e===this.line)return;this.line=e;let t=await this.studio.ask({kind:"line",line:e});t.kind==="place"&&t.line===this.line&&this.found(t)}};var Z1=["A","B","C"],ic=class{constructor(e){this.studio=e;e.verdicts.watch(t=>t&&this.show(t.verdicts)),e.state.watch(()=>this.age()),K(this.root,S("h2",{},"Verdicts"),S("p",{className:"quiet"},"…"))}studio;root=re("verdicts");age(){let{verdicts:e,state:t}=this.studio;this.root.classList.toggle("aged",e.value!==null&&e.value.revision!==t.value?.revision)}show(e){let t=e.filter(a=>a.passed).length,i=t===e.length,n=S("h2",{},"Verdicts ",S("span",{className:i?"pill good":"pill poor"},`${t} of ${e.length} met`)),r=e.map(a=>this.row(a)),o=S("p",{className:"quiet"},"The file has no [require] table: nothing is judged.");K(this.root,n,e.length?S("table",{className:"verdicts"},S("tbody",{},...r)):o),this.age()}row(e){let t=lo(e.value,e.old),i=`${e.key}: ${e.text}${e.point?` (${e.point})`:""}${t?`; in the file ${ht(e.old,e)}, now ${t}`:""}`;return S("tr",{className:e.value===null?"unknown":e.passed?"good":"poor",title:i,click:()=>this.studio.goto(e.line,!1)},S("th",{scope:"row"},S("b",{ariaLabel:e.passed?"met":"not met"},e.value===null?"?":e.passed?"✓":"✗"),` ${e.key}`),...e.value===null?[S("td",{className:"reason",colSpan:3},`${hv(e)}: ${e.reason||"not known"}`)]:this.cells(e))}cells(e){let t=S("span",{className:"margin"},S("i",{}));t.style.setProperty("--margin",String(Math.max(-1,Math.min(1,2*(e.margin??0)))));let i=e.margin===null?"":ei(e.margin)||"0 %";return[S("td",{className:"number"},ht(e.value,e)),S("td",{className:"quiet limit"},hv(e)),S("td",{className:"number"},t,i)]}};function hv(s){return`${s.text.includes("at most")||s.text.includes("below")?"≤":s.text.includes("at least")?"≥":""} ${ht(s.limit,s)}`}var nc=class{constructor(e){this.studio=e;K(this.root,this.pins,this.body),e.figures.watch(()=>this.results()),e.reach.watch(()=>this.results()),e.state.watch(()=>this.showPins()),e.keptOne.watch(()=>this.showPins()),e.against.watch(()=>this.showPins()),e.connection.on("frequencies",t=>this.live(t)),this.showPins()}studio;root=re("pane-figures");body=S("div",{});pins=S("div",{className:"bar"});cells=new Map;compared=null;all(){return[...this.studio.figures.value?.figures??[],...this.studio.reach.value?.figures??[]]}async results(){this.show(),this.studio.state.value?.pins.length&&this.studio.connection.newest("compare",{kind:"compare"},e=>{e.kind==="comparison"&&(this.compared=e),this.show()})}showPins(){let e=this.studio.state.value?.pins??[],t=this.studio.against.value,i=S("select",{ariaLabel:"Compare with",change:n=>this.studio.against.set(n.target.value)});i.append(new Option("file","",!1,t===""),...e.map(n=>new Option(n,n,!1,t===n))),K(this.pins,S("label",{},"old: ",i),S("span",{className:"buttons"},...Z1.map(n=>this.pin(n,e.includes(n)))))}pin(e,t){let i=t?`take ${e} back as the present design (shift: let it go)`:`pin the present design as ${e}`;return S("button",{type:"button",title:i,className:t?"pressed":"",click:n=>{this.press(e,t,n.shiftKey)}},t?e:`pin ${e}`)}async press(e,t,i){t&&!i?await this.studio.ask({kind:"recall",name:e}):await this.studio.ask({kind:"pin",name:e,keep:!t}),t||this.studio.keep(e),await this.results()}before(e){let t=this.studio.against.value;return t===""?e.old:this.pinned(e.name,t)}pinned(e,t){let i=this.compared?.figures.findIndex(r=>r.name===e)??-1,n=this.compared?.designs.indexOf(t)??-1;return this.compared?.values[i]?.[n]??null}show(){let e=[...rr(this.all(),l=>l.group)],{figures:t,reach:i}=this.studio,n=[["Stiffness",t.value?.stiffness],["Compliance",t.value?.compliance]].map(([l,c])=>c&&Jf(l,sc(c),l==="Stiffness")),r=Object.entries({...t.value?.missing,...i.value?.missing}).map(([l,c])=>S("p",{className:"quiet"},S("b",{},l),` ${c}`));this.cells.clear();let o=new Set([...this.body.querySelectorAll("details:not([open])")].map(l=>l.getAttribute("data-group"))),a=[...e.map(([l,c])=>Jf(l,this.table(c),!0)),this.losses(),...n];for(let l of a)l&&o.has(l.getAttribute("data-group"))&&(l.open=!1);K(this.body,...a,...r)}table(e){let t=(this.studio.state.value?.pins??[]).filter(n=>this.compared?.designs.includes(n)),i=["",this.studio.against.value||"old","new","change",...t];return sr(i,e.map(n=>this.row(n,t)),"figures")}row(e,t){let i=this.before(e),n=S("output",{},we(e.value===null?null:e.value/e.factor));n.dataset.figure=e.name,this.cells.set(e.name,n);let r=S("span",{},e.name,S("small",{className:"quiet"},e.unit==="1"?"":` ${e.unit}`)),o=S("span",{className:"quiet"},we(i===null?null:i/e.factor)),a=t.map(l=>we(j1(this.pinned(e.name,l),e.factor)));return[r,o,n,S("small",{},lo(e.value,i)),...a]}losses(){let e=this.studio.figures.value?.losses??[];if(!e.length)return null;let t=e.map(i=>[i.actuator,we(i.gain),ei(i.loss,4).replace("+",""),this.budget(i.budget)]);return Jf("Lost motion",sr(["","gain","loss","largest"],t,"figures"),!0)}budget(e){let t=Object.entries(e).sort(([,r],[,o])=>Math.abs(o)-Math.abs(r)),[i]=t,n=t.slice(0,12).map(([r,o])=>`${r} ${ei(o)}`).join(`
`);return S("small",{title:n},i?`${i[0]} ${ei(i[1],2).replace("+","")}`:"")}live(e){let t=this.all().filter(i=>/^frequency\.platform\./.test(i.name)||/platform.*mode|^f\d/.test(i.name));for(let[i,n]of t.entries()){let r=e.frequencies[i],o=this.cells.get(n.name);!o||r===void 0||(o.textContent=we(r),o.classList.add("moving"))}}},j1=(s,e)=>s===null?null:s/e;function Jf(s,e,t){let i=S("details",{open:t},S("summary",{},s),e);return i.dataset.group=s,i}function sc(s){let e=s.unit,t=s.values.map((i,n)=>[s.rows[n]??"",...i.map((r,o)=>S("span",{title:typeof e=="string"?e:e[n]?.[o]??""},we(r,4)))]);return S("div",{className:"wide"},sr([typeof e=="string"?e:"",...s.columns],t,"matrix"))}var Zf="http://www.w3.org/2000/svg",rc=class{constructor(e,t){this.studio=t;this.canvas.setAttribute("class","arrows"),this.canvas.setAttribute("aria-hidden","true"),e.append(this.canvas)}studio;canvas=document.createElementNS(Zf,"svg");layers=new Map;seen="";set(e,t){let i=this.layers.size===0;t.length?this.layers.set(e,t):this.layers.delete(e),this.seen="",i&&this.layers.size&&this.follow(),this.layers.size||this.canvas.replaceChildren()}follow(){if(!this.layers.size)return;let e=this.studio.viewer.value?.probe,t=e?JSON.stringify([e.camera,this.canvas.clientWidth,this.canvas.clientHeight]):"";e&&t!==this.seen&&this.draw(i=>e.project(i)),this.seen=t,requestAnimationFrame(()=>this.follow())}draw(e){let t=[...this.layers.values()].flat().flatMap(i=>Q1(i,e(i.from),e(i.to)));this.canvas.replaceChildren(...t)}};function Q1(s,e,t){let[i,n]=[t[0]-e[0],t[1]-e[1]],r=Math.hypot(i,n)||1,[o,a]=[i/r,n/r],l=(u,f)=>`${t[0]-u*o-f*a},${t[1]-u*a+f*o}`,c=uv("path",s.look,`M${e[0]},${e[1]}L${t[0]},${t[1]}`),h=(s.turns?[0,7]:[0]).map(u=>uv("path",`${s.look} head`,`M${l(u,0)}L${l(u+9,4)}L${l(u+9,-4)}Z`));return s.text?[c,...h,eA(s,t)]:[c,...h]}function uv(s,e,t){let i=document.createElementNS(Zf,s);return i.setAttribute("class",e),i.setAttribute("d",t),i}function eA(s,e){let t=document.createElementNS(Zf,"text");return t.setAttribute("class",s.look),t.setAttribute("x",String(e[0]+6)),t.setAttribute("y",String(e[1]-4)),t.textContent=s.text??"",t}var Rs=(s,e,t=1)=>[s[0]+t*(e[0]??0),s[1]+t*(e[1]??0),s[2]+t*(e[2]??0)],hn=s=>Math.hypot(...s);var fv={unit:"MPa",factor:1e6},oc=class{constructor(e,t){this.studio=e;this.lighten=t;K(re("pane-part"),S("div",{className:"bar"},S("label",{},"part ",this.pick)),this.body),K(this.body,S("p",{className:"quiet"},"Click a part of the stage, or put the cursor into its line of the file.")),e.state.watch(()=>this.offer()),e.link.watch(i=>this.choose(i)),e.reach.watch(()=>this.refresh())}studio;lighten;pick=S("select",{ariaLabel:"Part",change:()=>this.studio.link.set(this.pick.value||null)});body=S("div",{className:"card"});names="";offer(){let e=Object.keys(this.studio.state.value?.links??{});e.join()!==this.names&&(this.names=e.join(),this.pick.replaceChildren(new Option("none",""),...e.map(t=>new Option(t))),this.pick.value=this.studio.link.value??"")}choose(e){this.pick.value=e??"",e?this.studio.connection.newest("part",{kind:"part",link:e},t=>t.kind==="card"&&t.link===this.studio.link.value&&this.show(t,!0)):K(this.body)}refresh(){let e=this.studio.link.value;e&&!re("pane-part").hidden&&this.studio.connection.newest("part",{kind:"part",link:e},t=>t.kind==="card"&&this.show(t,!1))}show(e,t){t&&(this.studio.tab.set("part"),this.lighten(e));let i=e.lines.map(r=>S("button",{type:"button",click:()=>this.studio.goto(r)},`line ${r}`)),n=Object.entries(e.shares).sort(([,r],[,o])=>Math.abs(o)-Math.abs(r));K(this.body,S("h3",{},e.link,S("span",{className:"quiet"},` ${e.part} (${e.part_kind}) between ${e.bodies.join(" and ")}`)),S("div",{className:"buttons"},...i,S("button",{type:"button",click:()=>this.studio.viewer.value?.fit(e.link)},"fit")),Dr([...this.bears(e),...e.free.length?[{name:"free",text:e.free.join(", ")}]:[],...e.facts]),n.length?Dr(n.map(([r,o])=>({name:`of ${r}'s lost motion`,text:ei(o).replace("+","")||"0 %"}))):null,e.compliance&&jf("Compliance about its centre, in its own frame",sc(e.compliance)),e.stiffness&&jf("Stiffness",sc(e.stiffness)),e.verified.length?jf("Theory against finite elements",Dr(e.verified)):null,...e.problems.map(r=>S("p",{className:"fair"},`${r.what} ${r.advice}`)),...Object.entries(e.missing).map(([r,o])=>S("p",{className:"quiet"},S("b",{},r),` ${o}`)))}bears(e){if(e.stress===null)return[];let t=e.limit===null?"":` of ${ht(e.limit,fv,4)}`,i=e.safety===null?"":`, safety ${ht(e.safety,{unit:"1",factor:1},4)}`;return[{name:"peak stress",text:`${ht(e.stress,fv,4)}${t}${i}`}]}other(e){this.studio.tab.set("part");let{name:t,what:i,facts:n,line:r}=e.part,o=r===void 0?null:S("button",{type:"button",click:()=>this.studio.goto(r)},`line ${r}`);K(this.body,S("h3",{},t,S("span",{className:"quiet"},` ${i}`)),S("div",{className:"buttons"},o),Dr(n.map(([a,l])=>({name:a,text:l})))),this.studio.goto(r,!1)}};function Dr(s){return S("dl",{},...s.flatMap(e=>[S("dt",{},e.name),S("dd",{},e.text)]))}function jf(s,e){return S("div",{},S("h4",{},s),e)}var ac=class{constructor(e,t){this.studio=e;this.stage=t;e.tab.watch(i=>this.turn(i==="freedom")),e.figures.watch(()=>e.tab.value==="freedom"&&this.ask())}studio;stage;root=re("pane-freedom");said=null;turn(e){e?this.ask():this.picture(null)}ask(){this.studio.connection.newest("free",{kind:"free"},e=>e.kind==="freedoms"&&this.show(e))}show(e){this.said=e,K(this.root,S("p",{},`Mobility ${e.mobility}: the platform has ${e.free.length} free ${e.free.length===1?"motion":"motions"}.`),...dv("Free",e.free,t=>this.point([t])),...dv("Locked",e.locked,t=>this.point([t])),...Qf("What locks it",e.blocked),...Qf("Redundant constraints: they stress the stage where parts do not fit exactly",e.redundant),...Qf("Idle: motions that move neither platform nor stroke",e.idle),S("button",{type:"button",click:()=>this.picture(this.said)},"show all arrows")),this.picture(this.studio.tab.value==="freedom"?e:null)}picture(e){e===null?(this.stage.arrows.set("freedom",[]),this.studio.viewer.value?.setColours(null)):this.point([...e.free,...e.locked])}point(e){let{value:t}=this.studio.scene;if(!t)return;let i=new Set(this.said?.locked??[]);this.stage.arrows.set("freedom",e.map(r=>tA(r,t,i.has(r))));let n=e.filter(r=>i.has(r)).flatMap(r=>r.links);this.studio.viewer.value?.setColours(n.length?Object.fromEntries(n.map(r=>[r,[.82,.16,.16]])):null)}};function tA(s,e,t){let i=.28*e.size,n=s.pitch===null,r=n?e.reference:s.point,o=hn(s.direction)>0?s.direction:s.twist.slice(n?0:3),a=hn(o.slice(0,3))||1;return{from:r,to:Rs(r,o,i/a),look:t?"locked":"free",turns:!n,text:s.name}}function dv(s,e,t){if(!e.length)return[];let i=e.map(n=>S("li",{},S("button",{type:"button",click:()=>t(n)},n.name),` ${iA(n)}`));return[S("h4",{},s),S("ul",{},...i)]}function iA(s){let e=s.links.length?`; held by ${s.links.join(", ")}`:"";if(s.pitch===null)return`moves along (${s.direction.map(n=>we(n,3)).join(", ")})${e}`;let t=s.point.map(n=>we(1e3*n,4)).join(", "),i=Math.abs(s.pitch)<1e-9?"":`, ${we(1e3*s.pitch,4)} mm a radian`;return`turns about (${s.direction.map(n=>we(n,3)).join(", ")}) through (${t}) mm${i}${e}`}function Qf(s,e){return e.length?[S("h4",{},s),Dr(e)]:[]}var nA={unit:"mm",factor:.001},lc=class{constructor(e){this.studio=e;e.tab.watch(t=>t==="gaps"?this.ask():e.viewer.value?.setColours(null)),e.figures.watch(()=>e.tab.value==="gaps"&&this.ask())}studio;root=re("pane-gaps");ask(){this.root.childElementCount||K(this.root,S("p",{className:"quiet"},"Gaps are worked out…")),this.studio.connection.newest("gaps",{kind:"gaps"},e=>e.kind==="clearances"&&this.show(e))}show(e){let t=e.clashes.map(i=>[this.button(i),S("span",{className:i.distance<0?"poor":""},ht(i.distance,nA,4))]);K(this.root,...e.problems.map(i=>S("p",{className:"poor"},`${i.where}: ${i.what} ${i.advice}`)),e.clashes.length?sr(["bodies","distance"],t,"figures"):S("p",{className:"quiet"},"No clash, and no gap to tell."))}button(e){return S("button",{type:"button",title:e.text,click:()=>this.paint(e)},`${e.first} – ${e.second}`)}paint(e){let t=this.studio.scene.value?.parts??[],i=(o,a)=>o===a||o.startsWith(`${a}.`)||o.startsWith(`${a}/`),n=t.map(o=>o.name).filter(o=>i(o,e.first)||i(o,e.second)),r=o=>i(o,e.first)?[.85,.2,.15]:[.9,.55,.1];this.studio.viewer.value?.setColours(Object.fromEntries(n.map(o=>[o,r(o)])))}};var sA=6e3,cc=class{constructor(e,t){this.studio=e;this.editor=t;re("undo").addEventListener("click",()=>{this.undo()}),re("redo").addEventListener("click",()=>{this.redo()}),re("save").addEventListener("click",()=>{this.save()}),e.state.watch(i=>i&&this.show(i)),e.connection.state.watch(()=>this.tell()),e.connection.on("engine",i=>(this.engine=i,this.tell())),e.notice.watch(({text:i,bad:n})=>this.say(i,n)),this.tell()}studio;editor;engine=null;timer=0;show(e){K(re("file"),e.file.split(/[\\/]/).at(-1)??e.file),re("file").title=`${e.name}: ${e.file}`,K(re("changed"),e.saved?"saved":e.changed?`${e.changed} changed`:"text changed"),re("undo").disabled=!e.undo,re("redo").disabled=!e.redo,re("save").disabled=e.saved,document.title=`${e.saved?"":"• "}${e.name} – flexstage studio`}tell(){let e={opens:"connects…",open:"",lost:"connection lost; trying again",refused:"the server does not let this page in: open the address it printed"},t=this.studio.connection.state.value,i=this.engine,n=i?.seconds?`, ${we(i.seconds,2)} s`:"",r=i&&i.state!=="ready"?`${i.text||i.state}${n}`:"ready",o=re("engine");o.className=t!=="open"||i?.state==="ended"?"pill poor":i&&i.state!=="ready"?"pill fair":"pill good",K(o,e[t]||r)}say(e,t){let i=re("notice");clearTimeout(this.timer),i.hidden=e==="",i.className=t?"poor":"",K(i,e),e&&(this.timer=setTimeout(()=>this.studio.notice.set({text:"",bad:!1}),sA))}async undo(){this.editor.flush(),await this.studio.ask({kind:"undo"})}async redo(){await this.studio.ask({kind:"redo"})}async save(e=!1){this.editor.flush();let t=await this.studio.ask({kind:"save",over:e});t.kind==="refusal"&&t.stale?this.differs():t.kind!=="refusal"&&this.studio.tell("Saved.")}differs(){let e=re("notice");clearTimeout(this.timer);let t=i=>()=>(e.hidden=!0,i());e.hidden=!1,K(e,"Another program changed the file since it was read. ",S("button",{type:"button",click:t(()=>{this.save(!0)})},"write over it")," ",S("button",{type:"button",click:t(()=>{this.studio.ask({kind:"reload"})})},"take the file's text (undo brings yours back)"))}};function pv(s){let e=atob(s),t=new Uint8Array(e.length);for(let i=0;i<e.length;i+=1)t[i]=e.charCodeAt(i);return t.buffer}function Zo(s){return[...new Float64Array(pv(s.data))]}function ed(s){return new Float32Array(pv(s))}var uc=500,fc=class{constructor(e,t){this.studio=e;this.stage=t;let i=S("button",{type:"button",click:()=>this.reset()},"to zero");K(this.root,this.actuators,this.axes,S("div",{className:"bar"},i,S("label",{},"exaggeration ",this.factor),this.exaggeration),this.gauges,this.beyond),e.state.watch(()=>this.offer()),e.motion.watch(()=>this.fresh()),e.scene.watch(()=>this.isActive()&&this.draw()),e.figures.watch(()=>this.isShown()&&this.load()),e.mode.watch(n=>n!==null&&this.leave())}studio;stage;root=S("div",{className:"strip",id:"jog"});actuators=S("div",{className:"channels"});axes=S("div",{className:"channels"});gauges=S("div",{className:"gauges"});beyond=S("p",{className:"beyond",role:"status"});factor=S("input",{type:"range",min:0,max:6,step:.01,value:"3",ariaLabel:"Exaggeration",input:()=>this.draw()});exaggeration=S("output",{});draw=Sa(()=>this.drawNow());rows=new Map;axisRows=new Map;strokes=[];asked=-1;posed=null;isShown(){return this.root.offsetParent!==null}isActive(){return this.strokes.some(e=>e!==0)}load(){let e=this.studio.state.value?.revision??-1;e!==this.asked&&(this.asked=e,this.studio.connection.newest("jog",{kind:"jog"}))}offer(){let e=this.studio.state.value;e&&(this.rows=this.sliders(this.actuators,e.actuators,this.rows,(t,i)=>this.push(t,i)),this.axisRows=this.sliders(this.axes,e.axes,this.axisRows,(t,i)=>this.move(t,i)),this.strokes.length!==e.actuators.length&&(this.strokes=e.actuators.map(()=>0)))}sliders(e,t,i,n){let r=new Map(t.map((o,a)=>[o.name,i.get(o.name)??oA(o,l=>n(a,l))]));for(let o of t)r.get(o.name).channel=o;return[...r.keys()].join()!==[...i.keys()].join()&&K(e,...[...r.values()].map(o=>o.root)),r}fresh(){!this.isActive()&&(this.factor.value=String(Math.log10(this.fair()))),this.update()}fair(){let{scene:e}=this.studio,[t,i]=[...this.rows][0]??["",void 0],n=e.value?.motions.find(o=>o.group==="stroke"&&o.name===t),r=(n?.reach??0)*Math.abs(this.scale(n,0))*Nr(i?.channel);return r>0?Math.max(1,Math.min(1e6,.06*(e.value?.size??0)/r)):1e3}push(e,t){this.strokes[e]=t,this.moved()}move(e,t){let{value:i}=this.studio.motion;if(!i?.inputs)return this.studio.tell(i?.missing.inputs??"These actuators cannot move the platform along its axes.",!0);let n=this.twist(i);n[e]=t,this.strokes=hc(i.inputs.values,n),this.moved()}nudge(e,t){let i=this.axisRows.get(e),{value:n}=this.studio.motion;if(!i||!n)return this.load();let r=[...this.axisRows.keys()].indexOf(e);this.move(r,(this.twist(n)[r]??0)+t*Nr(i.channel)/20)}reset(){this.strokes=this.strokes.map(()=>0),this.moved(),this.leave()}leave(){this.strokes=this.strokes.map(()=>0),this.posed=null,this.studio.viewer.value?.setPose(null),this.update()}moved(){this.load(),this.studio.mode.set(null);let e=[...this.rows.keys()],t=Object.fromEntries(e.map((i,n)=>[i,this.strokes[n]??0]));this.update(),this.studio.connection.newest("pose",{kind:"pose",inputs:t},i=>{i.kind==="posed"&&(this.posed=i,this.update())})}twist(e){return hc(e.platform.values,this.strokes)}update(){let{value:e}=this.studio.motion,t=e?this.twist(e):[];[...this.rows.values()].forEach((i,n)=>mv(i,this.strokes[n]??0)),[...this.axisRows.values()].forEach((i,n)=>mv(i,t[n]??0)),this.read(e),this.judge(),this.draw()}read(e){let t=this.studio.state.value?.gauges??[],i=e?.gauges?hc(e.gauges.values,this.strokes):[],n=this.isActive()?this.posed?.beyond??{}:{};K(this.gauges,...t.map((r,o)=>S("span",{className:r.name in n?"poor":"",title:n[r.name]??""},S("b",{},r.name),` ${ht(this.reading(r.name,i[o]),r,4)}`)))}reading(e,t){return t??this.posed?.readings[e]??null}judge(){let e=this.isActive()?{...this.posed?.beyond}:{};for(let[i,n]of this.rows)rA(n.channel,Number(n.slider.dataset.value??0))&&(e[i]??=`${i} is at the end of its stroke`),n.root.classList.toggle("poor",i in e);let t=Object.keys(e).length>0;for(let i of this.axisRows.values())i.root.classList.toggle("poor",t&&Number(i.slider.dataset.value)!==0);K(this.beyond,...Object.values(e).map(i=>S("span",{className:"poor"},i))),this.paint(e)}paint(e){let t=Object.keys(e).filter(i=>i in(this.studio.state.value?.links??{}));this.studio.viewer.value?.setColours(t.length?Object.fromEntries(t.map(i=>[i,[.82,.16,.16]])):null)}drawNow(){let e=10**Number(this.factor.value);K(this.exaggeration,`drawn × ${we(e,3)}`);let{viewer:t,scene:i,motion:n}=this.studio;if(!this.isActive()||!i.value)return this.stage.arrows.set("jog",[]);t.value?.setPose(this.pose(i.value),e),n.value&&this.arrows(i.value,n.value,e)}pose(e){let t=new Float32Array(6*e.bodies.length);return[...this.rows.keys()].forEach((i,n)=>{let r=e.motions.find(a=>a.group==="stroke"&&a.name===i),o=this.scale(r,n)*(this.strokes[n]??0);!r||o===0||ed(r.twists).forEach((a,l)=>t[l]=(t[l]??0)+o*a)}),t}scale(e,t){let{value:i}=this.studio.scene,{value:n}=this.studio.motion;if(!e||!i||!n)return 0;let r=aA(ed(e.twists).subarray(6*i.platform,6*i.platform+6),i.reference),o=n.platform.values.map(f=>f[t]??0),a=i.size/2,l=f=>f.map((d,m)=>m<3?d:d*a),[c,h]=[l(r),l(o)],u=c.reduce((f,d)=>f+d*d,0);return u>0?c.reduce((f,d,m)=>f+d*(h[m]??0),0)/u:0}arrows(e,t,i){let n=e.reference,r=this.twist(t),o=t.ideal?hc(t.ideal.values,this.strokes):null,a=(c,h,u)=>({from:n,to:Rs(n,c.slice(0,3),i),look:h,text:u}),l=c=>hn(c.slice(0,3))*i>.01*e.size;this.stage.arrows.set("jog",[...o&&l(o)?[a(o,"ideal","ideal")]:[],...l(r)?[a(r,"real","")]:[]])}};function Nr(s){let e=Math.max(Math.abs(s?.low??0),Math.abs(s?.high??0));return e>0?e:s?.si==="rad"?.001:s?.si==="m"?1e-4:1}function rA(s,e){let t=1e-9*Nr(s);return s.high!==null&&e>s.high+t||s.low!==null&&e<s.low-t}function oA(s,e){let t=S("input",{type:"range",min:-uc,max:uc,step:1,value:"0",ariaLabel:s.name}),i=S("output",{}),n=S("label",{className:"channel"},S("b",{},s.name),t,i),r={channel:s,slider:t,told:i,root:n};return t.addEventListener("input",()=>e(1.2*Number(t.value)/uc*Nr(r.channel))),t.addEventListener("dblclick",()=>e(0)),r}function mv(s,e){s.slider.dataset.value=String(e),document.activeElement!==s.slider&&(s.slider.value=String(Math.round(uc*e/(1.2*Nr(s.channel))))),K(s.told,ht(Math.abs(e)<1e-9*Nr(s.channel)?0:e,s.channel,3))}function hc(s,e){return s.map(t=>t.reduce((i,n,r)=>i+(n??0)*(e[r]??0),0))}function aA(s,[e,t,i]){let[n=0,r=0,o=0,a=0,l=0,c=0]=s;return[n+l*i-c*t,r+c*e-a*i,o+a*t-l*e,a,l,c]}var lA=`# Which numbers vary, over which range, and what is worked out. See docs: studies.
[vary]
"parts.neck.thickness" = ["1.4 mm", "1.7 mm"]
`,cA=`# Which numbers are free, and what is to become best.
[vary]
"parts.neck.thickness" = ["1.4 mm", "1.7 mm"]

[objective]
maximise = "frequency.platform.1"
`,gv={sweep:{title:"Sweep",about:"Computes many designs and shows what varies with what.",study:lA,record:!1},optimise:{title:"Optimise",about:"Finds the best design within ranges and limits.",study:cA,record:!1},verify:{title:"Verify",about:"Compares theory with finite elements, hinges first.",study:null,record:!1},identify:{title:"Identify",about:"Finds the modes in a record of a test.",study:null,record:!0},loop:{title:"Loop",about:"Closes the control loop; without a set-up the usual one.",study:"",record:!1},analyse:{title:"Report",about:"Writes the report: everything at once, with the turning model, in one file.",study:null,record:!1}},dc=class{constructor(e){this.studio=e;K(this.root,this.form,this.list);let t=Object.entries(gv).map(([i,n])=>S("button",{type:"button",title:n.about,click:()=>this.offer(i)},n.title));K(re("commands"),...t),e.connection.on("jobs",i=>this.show(i)),K(this.list,S("p",{className:"quiet"},"No jobs yet."))}studio;root=re("pane-jobs");list=S("div",{id:"jobs"});form=S("div",{});studies=new Map;live=new Set;offer(e){let t=gv[e];if(this.studio.tab.set("jobs"),e==="analyse")return void this.run({kind:"run",command:e,study:null,record:null,options:[]});let i=t.study===null?null:S("textarea",{rows:9,spellcheck:!1,ariaLabel:"study",value:this.studies.get(e)??t.study}),n=t.record?S("input",{type:"text",required:!0,placeholder:"record.mat",ariaLabel:"record"}):null,r=S("input",{type:"text",placeholder:"--modes 12",ariaLabel:"options"}),o=a=>{a.preventDefault(),i&&this.studies.set(e,i.value),this.run({kind:"run",command:e,study:i?.value.trim()?i.value:null,record:n?.value||null,options:r.value.split(/\s+/).filter(Boolean)})};K(this.form,S("form",{className:"run",submit:o},S("h3",{},t.title),S("p",{className:"quiet"},t.about),i,n&&S("label",{},"record's file ",n),S("label",{},"options ",r),S("button",{type:"submit"},`Start ${t.title.toLowerCase()}`))),(i??n??r).focus()}async run(e){let t=await this.studio.ask(e);t.kind==="done"?K(this.form):t.kind==="refusal"&&K(this.form,...t.problems.map(i=>S("p",{className:"poor"},`${i.where}: ${i.what} ${i.advice}`)))}show(e){K(this.list,...[...e.jobs].reverse().map(t=>this.job(t)));for(let t of e.jobs)this.live.has(t.job)&&td(t)&&this.studio.tell(`${t.command}: ${t.state}.`,t.state==="failed");this.live=new Set(e.jobs.filter(t=>!td(t)).map(t=>t.job))}job(e){let t=!td(e),i=e.left===null?"":`, ${we(Math.ceil(e.left),3)} s left`,n=S("button",{type:"button",click:()=>this.studio.ask({kind:"cancel",job:e.job})},"cancel"),r=e.report&&S("a",{href:e.report,target:"_blank",rel:"noopener"},"open the report"),o=S("progress",{ariaLabel:e.command,max:1,...e.fraction===null?{}:{value:e.fraction}});return S("article",{className:`job ${e.state}`},S("h3",{},`${e.command} `,S("span",{className:"quiet"},`${e.state}${i}`),t&&n,r),t&&o,S("p",{},e.text),e.said.length>0&&S("pre",{},e.said.join(`
`)))}},td=s=>s.state!=="waits"&&s.state!=="runs";function xv(s){window.addEventListener("keydown",e=>hA(e,s),{capture:!0}),re("help").addEventListener("click",()=>id(s))}function hA(s,e){let t=uA(s),i=e.find(n=>n.keys.includes(t));!i||fA(s)&&!i.always||dA(s)&&/arrow|page/.test(t)||document.querySelector("dialog[open]")||t==="space"&&s.composedPath()[0]instanceof HTMLButtonElement||(s.preventDefault(),s.stopImmediatePropagation(),i.act(t))}function uA(s){let e=s.key===" "?"space":s.key.toLowerCase(),t=s.ctrlKey||s.metaKey?"mod+":"",i=s.shiftKey&&(e.length>1||t)?"shift+":"";return`${t}${s.altKey?"alt+":""}${i}${e}`}function fA(s){let e=s.composedPath()[0];return e instanceof HTMLElement?e instanceof HTMLInputElement&&!["range","checkbox"].includes(e.type)||e instanceof HTMLTextAreaElement||e instanceof HTMLSelectElement||e.isContentEditable:!1}function dA(s){let e=s.composedPath()[0];return e instanceof HTMLInputElement&&e.type==="range"}function id(s){let e=S("dialog",{className:"keys",ariaLabel:"Keys",close:()=>e.remove()}),t=s.filter(i=>i.shown).flatMap(i=>[S("dt",{},S("kbd",{},i.shown)),S("dd",{},i.about)]);K(e,S("h2",{},"Keys"),S("dl",{},...t),S("form",{method:"dialog"},S("button",{},"close"))),document.body.append(e),e.showModal()}var vv={figures:"Figures",part:"Part",freedom:"Freedom",gaps:"Gaps",build:"Build",jobs:"Jobs"};function yv(s){let e=i=>{for(let n of Object.keys(vv))re(`pane-${n}`).hidden=n!==i;for(let n of t)n.setAttribute("aria-selected",String(n.dataset.tab===i))},t=Object.entries(vv).map(([i,n])=>{let r=S("button",{type:"button",role:"tab","aria-controls":`pane-${i}`,click:()=>s.tab.set(i)},n);return r.dataset.tab=i,r});K(re("tabs"),...t),re("tabs").addEventListener("keydown",i=>pA(i,t)),s.tab.watch(e),e(s.tab.value)}function pA(s,e){let t=e.indexOf(s.target),i=s.key==="ArrowRight"?1:s.key==="ArrowLeft"?-1:0;i===0||t<0||(s.stopPropagation(),e.at((t+i)%e.length)?.focus())}var mA=[{name:"left",variable:"--left",axis:"x",sign:1},{name:"right",variable:"--right",axis:"x",sign:-1},{name:"bottom",variable:"--bottom",axis:"y",sign:-1},{name:"middle",variable:"--middle",axis:"x",sign:1}];function bv(){re("studio").append(...mA.map(gA))}function gA(s){let e=S("div",{className:`edge ${s.name}`,role:"separator",tabIndex:0,ariaLabel:`edge of the ${s.name} pane`,ariaOrientation:s.axis==="x"?"vertical":"horizontal"}),t=re("studio"),i=n=>{let r=Number.parseFloat(getComputedStyle(t).getPropertyValue(s.variable));t.style.setProperty(s.variable,`${Math.max(120,r+s.sign*n)}px`)};return e.addEventListener("pointerdown",n=>e.setPointerCapture(n.pointerId)),e.addEventListener("pointermove",n=>e.hasPointerCapture(n.pointerId)&&i(s.axis==="x"?n.movementX:n.movementY)),e.addEventListener("keydown",n=>{let r={ArrowLeft:-16,ArrowUp:-16,ArrowRight:16,ArrowDown:16}[n.key];r&&(i(r),n.stopPropagation())}),e}var pc=class{constructor(e,t){this.studio=e;this.stage=t;let i=S("label",{},S("input",{type:"checkbox",change:r=>e.viewer.value?.showEnergy(r.target.checked)}),"strain energy"),n=S("label",{},S("input",{type:"checkbox",change:r=>this.two(r.target.checked)}),"two side by side");K(this.root,S("div",{className:"bar"},this.list,this.beside,this.button,i,n),S("div",{className:"bar"},S("label",{},"phase ",this.phase),S("label",{},"amplitude ",this.amplitude),this.factor),this.about),e.figures.watch(r=>r&&this.offer(r.modes)),e.mode.watch(()=>this.play()),e.viewer.watch(()=>this.play()),e.scene.watch(()=>this.play())}studio;stage;root=S("div",{className:"strip"});list=S("select",{id:"modes",ariaLabel:"Mode",change:()=>this.studio.mode.set(this.list.value?Number(this.list.value):null)});beside=S("select",{ariaLabel:"Second mode",hidden:!0,change:()=>this.playSecond()});phase=S("input",{type:"range",min:0,max:1,step:.005,value:"0",ariaLabel:"Phase",input:()=>this.scrub()});amplitude=S("input",{type:"range",min:.005,max:.2,step:.005,value:"0.06",ariaLabel:"Amplitude",input:()=>this.scale()});factor=S("output",{});button=S("button",{type:"button",title:"space",click:()=>this.toggle()},"pause");about=S("p",{className:"quiet about"});isPlaying=!0;second=null;offer(e){for(let t of[this.list,this.beside]){let i=t.value,n=new Option(t===this.list?"at rest (0)":"second mode","");t.replaceChildren(n,...e.map(r=>new Option(`${r.number}   ${we(r.frequency)} Hz   ${r.name}`,String(r.number)))),t.value=e.some(r=>String(r.number)===i)?i:""}this.tell()}chosen(){let e=this.studio.mode.value;return this.studio.figures.value?.modes.find(t=>t.number===e)??null}motion(e){return this.studio.scene.value?.motions.find(t=>t.group==="mode"&&t.name===String(e))??null}play(){let e=this.studio.mode.value;this.list.value=e===null?"":String(e);let t=this.motion(e),{value:i}=this.studio.viewer;i?.setMotion(t?{group:"mode",name:t.name}:null),t&&i?.setPlaying(this.isPlaying),t&&i?.setAmplitude(Number(this.amplitude.value)),this.tell(),this.arrow()}tell(){let e=this.chosen(),t=e===null?[]:Object.entries(e.strain).slice(0,4).map(([n,r])=>`${n} ${ei(r,2).slice(1)}`),i=e?.platform?"platform's mode":e?.local?"local":"";K(this.about,e===null?"1 to 9 play a mode, 0 stops; a click at a peak of the response plays its mode.":`${i?`${i}, `:""}platform ${we(100*e.share,4)} % of kinetic energy${t.length?`; strain energy: ${t.join(", ")}`:""}`),this.written()}written(){let e=this.studio.viewer.value?.probe,t=this.motion(this.studio.mode.value),i=this.studio.scene.value?.size??0,n=Number(this.amplitude.value)*i,r=t?.scaled?`drawn × ${we(e?.factor??null,3)}`:`largest motion drawn as ${we(1e3*n,3)} mm`;K(this.factor,t&&e?r:"")}toggle(){this.isPlaying=!this.isPlaying,this.button.textContent=this.isPlaying?"pause":"play",this.studio.viewer.value?.setPlaying(this.isPlaying),this.second?.setPlaying(this.isPlaying),this.phase.value=String(this.studio.viewer.value?.probe.phase??0)}scrub(){this.isPlaying&&this.toggleQuietly(),this.studio.viewer.value?.setPhase(Number(this.phase.value)),this.second?.setPhase(Number(this.phase.value))}toggleQuietly(){let e=this.phase.value;this.toggle(),this.phase.value=e}scale(){this.studio.viewer.value?.setAmplitude(Number(this.amplitude.value)),this.second?.setAmplitude(Number(this.amplitude.value)),this.written()}louder(e){this.amplitude.value=String(Number(this.amplitude.value)*e),this.scale()}two(e){this.beside.hidden=!e,this.second=this.stage.beside(e),e&&!this.beside.value&&(this.beside.value=String((this.studio.mode.value??0)+1)),this.playSecond()}playSecond(){let e=this.motion(Number(this.beside.value));this.second?.setMotion(e?{group:"mode",name:e.name}:null),this.second?.setAmplitude(Number(this.amplitude.value)),this.second?.setPlaying(this.isPlaying)}arrow(){let e=this.chosen(),t=this.studio.scene.value;this.stage.arrows.set("mode",e&&t?xA(e.twist,t.reference,.22*t.size):[])}};function xA(s,e,t){let[i,n]=[s.slice(0,3),s.slice(3)],r=Math.max(hn(i),hn(n)*2*t)||1,o=[];return hn(i)>.15*r&&o.push({from:e,to:Rs(e,i,t/r),look:"real"}),hn(n)*2*t>.15*r&&o.push({from:e,to:Rs(e,n,2*t*t/r),look:"real",turns:!0}),o}function _v(s,e){let t={modes:s.root,jog:e},i=Object.keys(t).map(r=>S("button",{type:"button",role:"tab",click:()=>n(r)},r==="modes"?"Modes":"Jog")),n=r=>{for(let[o,a]of Object.entries(t))a.hidden=o!==r;for(let[o,a]of Object.keys(t).entries())i[o]?.setAttribute("aria-selected",String(a===r))};return K(re("motion"),S("div",{className:"bar tabs",role:"tablist"},...i),s.root,e),n("modes"),n}var nd=1e3,vA=40,mc=class{constructor(e){this.studio=e;this.order.append(new Option("as in the file","file"),new Option("by what it buys","worth"),new Option("changed first","changed")),K(re("numbers"),S("div",{className:"bar"},S("h2",{},"Numbers"),this.filter,this.order),this.list,S("div",{className:"bar foot"},this.count)),e.state.watch(()=>this.update()),e.slopes.watch(t=>t&&this.buy(t)),e.verdicts.watch(()=>e.connection.newest("derive",{kind:"derive"})),e.connection.on("frequencies",t=>this.warn(t))}studio;rows=new Map;list=S("div",{id:"amounts"});filter=S("input",{type:"search",id:"filter",placeholder:"find  /",ariaLabel:"Find a number",input:()=>this.sift()});order=S("select",{ariaLabel:"Order",change:()=>this.layout()});count=S("output",{className:"quiet"});held=null;layoutOf="";find(){this.filter.focus(),this.filter.select()}reveal(e){for(let[n,r]of this.rows)r.root.classList.toggle("selected",e.includes(n));let t=e.map(n=>this.rows.get(n)).find(n=>n!==void 0),i=t?.root.closest("details");i&&(i.open=!0),t?.root.offsetParent&&t.root.scrollIntoView({block:"nearest"})}update(){let e=this.studio.state.value;if(!e)return;let t=new Set(e.amounts.map(i=>i.address));for(let[i,n]of this.rows)t.has(i)||(this.rows.delete(i),n.root.remove());for(let i of e.amounts)this.show(this.rows.get(i.address)??this.row(i),i);this.layout(),K(this.count,`${e.amounts.length} numbers`,e.changed?`, ${e.changed} changed`:"")}row(e){let t=e.address,i=S("input",{type:"range",min:0,max:nd,step:1,tabIndex:-1,ariaLabel:`${t}, slider`}),n=S("input",{type:"text",spellcheck:!1,autocomplete:"off",ariaLabel:t}),r=S("span",{className:"buys"}),o=S("button",{type:"button",className:"was",title:"take the file's value back"}),a=S("button",{type:"button",className:"name",title:t},t.slice(e.group.length).replace(/^\./,"")||t),l=S("div",{className:"amount"},a,i,n,r,o);l.dataset.address=t;let c={amount:e,root:l,slider:i,field:n,buys:r,was:o};return this.rows.set(t,c),this.wire(c,a),c}wire(e,t){let{slider:i,field:n,was:r}=e,o=e.amount.address,a=co(vA,()=>this.rest(e));i.addEventListener("pointerdown",()=>this.studio.ask({kind:"grip",address:o,low:e.amount.low,high:e.amount.high})),i.addEventListener("input",()=>this.drag(e,a)),i.addEventListener("change",()=>a.now()),n.addEventListener("keydown",l=>this.type(e,l)),n.addEventListener("blur",()=>this.enter(e)),r.addEventListener("click",()=>e.amount.old!==null&&this.studio.ask({kind:"rest",address:o,value:e.amount.old})),t.addEventListener("click",()=>this.choose(e))}choose(e){this.reveal([e.amount.address]),this.studio.goto(e.amount.line,!1)}at(e){let{low:t,high:i}=e.amount;return t+Number(e.slider.value)/nd*(i-t)}drag(e,t){let i=this.at(e);this.held=e.amount.address,e.field.value=ht(i,e.amount),e.root.classList.remove("bad"),this.studio.connection.newest("drag",{kind:"drag",address:e.amount.address,value:i}),t()}rest(e){this.studio.connection.drop("drag");let t=Number(yA(this.at(e)/e.amount.factor))*e.amount.factor;this.studio.connection.newest("rest",{kind:"rest",address:e.amount.address,value:t},()=>this.held=null)}type(e,t){if(t.key==="Enter")this.enter(e);else if(t.key==="Escape")e.field.value=e.amount.text;else if(t.key==="ArrowUp"||t.key==="ArrowDown")this.step(e,t.key==="ArrowUp"?1:-1,t.shiftKey);else return;t.key.startsWith("Arrow")&&t.preventDefault()}step(e,t,i){e.slider.value=String(Number(e.slider.value)+t*(i?1:10)),e.slider.dispatchEvent(new Event("input"))}async enter(e){let t=e.field.value.trim();if(t===e.amount.text||e.amount.address===this.held)return;let i=await this.studio.ask({kind:"set",address:e.amount.address,text:t});e.root.classList.toggle("bad",i.kind==="refusal"),e.field.title=i.kind==="refusal"?i.problems.map(n=>n.what).join(" "):""}show(e,t){e.amount=t;let i=this.held===t.address,n=document.activeElement===e.field&&e.root.classList.contains("bad");!i&&!n&&(e.field.value=t.text,e.slider.value=String(Math.round(nd*(t.value-t.low)/(t.high-t.low||1))),e.root.classList.remove("bad")),e.slider.disabled=t.high<=t.low||t.formula!==null,e.slider.title=`${ht(t.low,t)} to ${ht(t.high,t)}`;let r=t.old!==null&&t.old!==t.value;e.root.classList.toggle("changed",r),K(e.was,r?`was ${ht(t.old,t)}  ${lo(t.value,t.old)}`:""),e.field.title=t.formula?`${t.formula} = ${ht(t.value,t)}`:t.tag}buy(e){let t=new Map(e.slopes.map(n=>[n.address,n])),i=Math.max(...e.slopes.map(n=>Math.abs(n.worst??0)),1e-12);for(let[n,r]of this.rows){let a=t.get(n)?.worst??null;K(r.buys,a===null||Math.abs(a)<1e-6?"":ei(a,2).replace(" %","")),r.buys.title=a===null?"":`one per cent more changes the margin of ${e.worst} by ${ei(a)}`,r.buys.dataset.gain=String(a??0),r.buys.style.setProperty("--share",String(Math.abs(a??0)/i)),r.buys.classList.toggle("minus",(a??0)<0)}this.order.title=`what one per cent of a number changes in the margin of ${e.worst} [%]`,this.order.value==="worth"&&this.layout()}ordered(){let e=[...this.studio.state.value?.amounts??[]].map(n=>this.rows.get(n.address)).filter(n=>n!==void 0),t=this.order.value;return t==="worth"?[[`for ${this.studio.slopes.value?.worst||"the worst requirement"}`,e.sort((n,r)=>Sv(r)-Sv(n))]]:[...rr(e,n=>t==="changed"&&n.root.classList.contains("changed")?"changed":n.amount.group)].sort(([n],[r])=>+(r==="changed")-+(n==="changed"))}layout(){let e=this.ordered(),t=e.map(([i,n])=>`${i}:${n.map(r=>r.amount.address).join()}`).join("|");if(t!==this.layoutOf){let i=new Set([...this.list.querySelectorAll("details:not([open])")].map(n=>n.getAttribute("data-table")));K(this.list,...e.map(([n,r])=>bA(n,r,!i.has(n),this.order.value==="worth"))),this.layoutOf=t}this.sift()}sift(){let e=this.filter.value.toLowerCase().split(/\s+/).filter(Boolean);for(let[t,i]of this.rows){let n=`${t} ${i.amount.tag} ${i.amount.unit}`.toLowerCase();i.root.hidden=!e.every(r=>n.includes(r))}for(let t of this.list.querySelectorAll("details")){let i=t.querySelector(".amount:not([hidden])")!==null;t.hidden=!i,e.length&&i&&(t.open=!0)}}warn(e){this.rows.get(e.address)?.root.classList.toggle("bad",e.problems.length>0),e.problems.length&&this.studio.tell(e.problems.map(i=>i.what).join(" "),!0)}},Sv=s=>Math.abs(Number(s.buys.dataset.gain??0));function yA(s){return s.toPrecision(5)}function bA(s,e,t,i){for(let r of e){let[o]=r.root.getElementsByClassName("name"),a=r.amount.address.slice(r.amount.group.length).replace(/^[./]/,"");o&&(o.textContent=i?r.amount.address:a||r.amount.address)}let n=S("details",{open:t},S("summary",{},s||"stage",S("span",{className:"quiet"},` ${we(e.length)}`)),...e.map(r=>r.root));return n.dataset.table=s,n}var _A="uplot",SA="u-hz",wA="u-vt",MA="u-title",AA="u-wrap",TA="u-under",EA="u-over",CA="u-axis",Ls="u-off",RA="u-select",PA="u-cursor-x",kA="u-cursor-y",LA="u-cursor-pt",IA="u-legend",DA="u-live",NA="u-inline",OA="u-series",FA="u-marker",wv="u-label",BA="u-value",Qo="width",ea="height";var Mv="bottom",Or="left",sd="right",_d="#000",Av=_d+"0",rd="mousemove",Tv="mousedown",od="mouseup",Ev="mouseenter",Cv="mouseleave",Rv="dblclick",UA="resize",zA="scroll",Pv="change",bc="dppxchange",Sd="--",Gr=typeof window<"u",ud=Gr?document:null,Br=Gr?window:null,VA=Gr?navigator:null,Re,gc;function fd(){let s=devicePixelRatio;Re!=s&&(Re=s,gc&&pd(Pv,gc,fd),gc=matchMedia(`(min-resolution: ${Re-.001}dppx) and (max-resolution: ${Re+.001}dppx)`),Is(Pv,gc,fd),Br.dispatchEvent(new CustomEvent(bc)))}function oi(s,e){if(e!=null){let t=s.classList;!t.contains(e)&&t.add(e)}}function dd(s,e){let t=s.classList;t.contains(e)&&t.remove(e)}function qe(s,e,t){s.style[e]=t+"px"}function Wi(s,e,t,i){let n=ud.createElement(s);return e!=null&&oi(n,e),t?.insertBefore(n,i),n}function Ti(s,e){return Wi("div",s,e)}var kv=new WeakMap;function un(s,e,t,i,n){let r="translate("+e+"px,"+t+"px)",o=kv.get(s);r!=o&&(s.style.transform=r,kv.set(s,r),e<0||t<0||e>i||t>n?oi(s,Ls):dd(s,Ls))}var Lv=new WeakMap;function Iv(s,e,t){let i=e+t,n=Lv.get(s);i!=n&&(Lv.set(s,i),s.style.background=e,s.style.borderColor=t)}var Dv=new WeakMap;function Nv(s,e,t,i){let n=e+""+t,r=Dv.get(s);n!=r&&(Dv.set(s,n),s.style.height=t+"px",s.style.width=e+"px",s.style.marginLeft=i?-e/2+"px":0,s.style.marginTop=i?-t/2+"px":0)}var wd={passive:!0},HA={...wd,capture:!0};function Is(s,e,t,i){e.addEventListener(s,t,i?HA:wd)}function pd(s,e,t,i){e.removeEventListener(s,t,wd)}Gr&&fd();function qi(s,e,t,i){let n;t=t||0,i=i||e.length-1;let r=i<=2147483647;for(;i-t>1;)n=r?t+i>>1:ai((t+i)/2),e[n]<s?t=n:i=n;return s-e[t]<=e[i]-s?t:i}function cy(s){return(t,i,n)=>{let r=-1,o=-1;for(let a=i;a<=n;a++)if(s(t[a])){r=a;break}for(let a=n;a>=i;a--)if(s(t[a])){o=a;break}return[r,o]}}var hy=s=>s!=null,uy=s=>s!=null&&s>0,wc=cy(hy),GA=cy(uy);function WA(s,e,t,i=0,n=!1){let r=n?GA:wc,o=n?uy:hy;[e,t]=r(s,e,t);let a=s[e],l=s[e];if(e>-1)if(i==1)a=s[e],l=s[t];else if(i==-1)a=s[t],l=s[e];else for(let c=e;c<=t;c++){let h=s[c];o(h)&&(h<a?a=h:h>l&&(l=h))}return[a??Oe,l??-Oe]}function Mc(s,e,t,i){let n=Bv(s),r=Bv(e);s==e&&(n==-1?(s*=t,e/=t):(s/=t,e*=t));let o=t==10?_n:fy,a=n==1?ai:Ei,l=r==1?Ei:ai,c=a(o(dt(s))),h=l(o(dt(e))),u=Ur(t,c),f=Ur(t,h);return t==10&&(c<0&&(u=Fe(u,-c)),h<0&&(f=Fe(f,-h))),i||t==2?(s=u*n,e=f*r):(s=gy(s,u),e=Ac(e,f)),[s,e]}function Md(s,e,t,i){let n=Mc(s,e,t,i);return s==0&&(n[0]=0),e==0&&(n[1]=0),n}var Ad=.1,Ov={mode:3,pad:Ad},ia={pad:0,soft:null,mode:0},qA={min:ia,max:ia};function _c(s,e,t,i){return Tc(t)?Fv(s,e,t):(ia.pad=t,ia.soft=i?0:null,ia.mode=i?3:0,Fv(s,e,qA))}function Te(s,e){return s??e}function XA(s,e,t){for(e=Te(e,0),t=Te(t,s.length-1);e<=t;){if(s[e]!=null)return!0;e++}return!1}function Fv(s,e,t){let i=t.min,n=t.max,r=Te(i.pad,0),o=Te(n.pad,0),a=Te(i.hard,-Oe),l=Te(n.hard,Oe),c=Te(i.soft,Oe),h=Te(n.soft,-Oe),u=Te(i.mode,0),f=Te(n.mode,0),d=e-s,m=_n(d),g=Gt(dt(s),dt(e)),y=_n(g),_=dt(y-m);(d<1e-24||_>10)&&(d=0,(s==0||e==0)&&(d=1e-24,u==2&&c!=Oe&&(r=0),f==2&&h!=-Oe&&(o=0)));let w=d||g||1e3,A=_n(w),T=Ur(10,ai(A)),C=w*(d==0?s==0?.1:1:r),E=Fe(gy(s-C,T/10),24),P=s>=c&&(u==1||u==3&&E<=c||u==2&&E>=c)?c:Oe,O=Gt(a,E<P&&s>=P?P:Xi(P,E)),H=w*(d==0?e==0?.1:1:o),G=Fe(Ac(e+H,T/10),24),k=e<=h&&(f==1||f==3&&G>=h||f==2&&G<=h)?h:-Oe,D=Xi(l,G>k&&e<=k?k:Gt(k,G));return O==D&&O==0&&(D=100),[O,D]}var $A=new Intl.NumberFormat(Gr?VA.language:"en-US"),Td=s=>$A.format(s),li=Math,yc=li.PI,dt=li.abs,ai=li.floor,ft=li.round,Ei=li.ceil,Xi=li.min,Gt=li.max,Ur=li.pow,Bv=li.sign,_n=li.log10,fy=li.log2,YA=(s,e=1)=>li.sinh(s)*e,ad=(s,e=1)=>li.asinh(s/e),Oe=1/0;function Uv(s){return(_n((s^s>>31)-(s>>31))|0)+1}function md(s,e,t){return Xi(Gt(s,e),t)}function dy(s){return typeof s=="function"}function ve(s){return dy(s)?s:()=>s}var KA=()=>{},py=s=>s,my=(s,e)=>e,JA=s=>null,zv=s=>!0,Vv=(s,e)=>s==e,ZA=/\.\d*?(?=9{6,}|0{6,})/gm,Ds=s=>{if(vy(s)||$n.has(s))return s;let e=`${s}`,t=e.match(ZA);if(t==null)return s;let i=t[0].length-1;if(e.indexOf("e-")!=-1){let[n,r]=e.split("e");return+`${Ds(n)}e${r}`}return Fe(s,i)};function Ps(s,e){return Ds(Fe(Ds(s/e))*e)}function Ac(s,e){return Ds(Ei(Ds(s/e))*e)}function gy(s,e){return Ds(ai(Ds(s/e))*e)}function Fe(s,e=0){if(vy(s))return s;let t=10**e,i=s*t*(1+Number.EPSILON);return ft(i)/t}var $n=new Map;function xy(s){return((""+s).split(".")[1]||"").length}function sa(s,e,t,i){let n=[],r=i.map(xy);for(let o=e;o<t;o++){let a=dt(o),l=Fe(Ur(s,o),a);for(let c=0;c<i.length;c++){let h=s==10?+`${i[c]}e${o}`:i[c]*l,u=(o>=0?0:a)+(o>=r[c]?0:r[c]),f=s==10?h:Fe(h,u);n.push(f),$n.set(f,u)}}return n}var na={},Ed=[],zr=[null,null],Xn=Array.isArray,vy=Number.isInteger,jA=s=>s===void 0;function Hv(s){return typeof s=="string"}function Tc(s){let e=!1;if(s!=null){let t=s.constructor;e=t==null||t==Object}return e}function QA(s){return s!=null&&typeof s=="object"}var eT=Object.getPrototypeOf(Uint8Array),yy="__proto__";function Vr(s,e=Tc){let t;if(Xn(s)){let i=s.find(n=>n!=null);if(Xn(i)||e(i)){t=Array(s.length);for(let n=0;n<s.length;n++)t[n]=Vr(s[n],e)}else t=s.slice()}else if(s instanceof eT)t=s.slice();else if(e(s)){t={};for(let i in s)i!=yy&&(t[i]=Vr(s[i],e))}else t=s;return t}function lt(s){let e=arguments;for(let t=1;t<e.length;t++){let i=e[t];for(let n in i)n!=yy&&(Tc(s[n])?lt(s[n],Vr(i[n])):s[n]=Vr(i[n]))}return s}var tT=0,iT=1,nT=2;function sT(s,e,t){for(let i=0,n,r=-1;i<e.length;i++){let o=e[i];if(o>r){for(n=o-1;n>=0&&s[n]==null;)s[n--]=null;for(n=o+1;n<t&&s[n]==null;)s[r=n++]=null}}}function rT(s,e){if(lT(s)){let o=s[0].slice();for(let a=1;a<s.length;a++)o.push(...s[a].slice(1));return cT(o[0])||(o=aT(o)),o}let t=new Set;for(let o=0;o<s.length;o++){let l=s[o][0],c=l.length;for(let h=0;h<c;h++)t.add(l[h])}let i=[Array.from(t).sort((o,a)=>o-a)],n=i[0].length,r=new Map;for(let o=0;o<n;o++)r.set(i[0][o],o);for(let o=0;o<s.length;o++){let a=s[o],l=a[0];for(let c=1;c<a.length;c++){let h=a[c],u=Array(n).fill(void 0),f=e?e[o][c]:iT,d=[];for(let m=0;m<h.length;m++){let g=h[m],y=r.get(l[m]);g===null?f!=tT&&(u[y]=g,f==nT&&d.push(y)):u[y]=g}sT(u,d,n),i.push(u)}}return i}var oT=typeof queueMicrotask>"u"?s=>Promise.resolve().then(s):queueMicrotask;function aT(s){let e=s[0],t=e.length,i=Array(t);for(let r=0;r<i.length;r++)i[r]=r;i.sort((r,o)=>e[r]-e[o]);let n=[];for(let r=0;r<s.length;r++){let o=s[r],a=Array(t);for(let l=0;l<t;l++)a[l]=o[i[l]];n.push(a)}return n}function lT(s){let e=s[0][0],t=e.length;for(let i=1;i<s.length;i++){let n=s[i][0];if(n.length!=t)return!1;if(n!=e){for(let r=0;r<t;r++)if(n[r]!=e[r])return!1}}return!0}function cT(s,e=100){let t=s.length;if(t<=1)return!0;let i=0,n=t-1;for(;i<=n&&s[i]==null;)i++;for(;n>=i&&s[n]==null;)n--;if(n<=i)return!0;let r=Gt(1,ai((n-i+1)/e));for(let o=s[i],a=i+r;a<=n;a+=r){let l=s[a];if(l!=null){if(l<=o)return!1;o=l}}return!0}var by=["January","February","March","April","May","June","July","August","September","October","November","December"],_y=["Sunday","Monday","Tuesday","Wednesday","Thursday","Friday","Saturday"];function Sy(s){return s.slice(0,3)}var hT=_y.map(Sy),uT=by.map(Sy),fT={MMMM:by,MMM:uT,WWWW:_y,WWW:hT};function jo(s){return(s<10?"0":"")+s}function dT(s){return(s<10?"00":s<100?"0":"")+s}var pT={YYYY:s=>s.getFullYear(),YY:s=>(s.getFullYear()+"").slice(2),MMMM:(s,e)=>e.MMMM[s.getMonth()],MMM:(s,e)=>e.MMM[s.getMonth()],MM:s=>jo(s.getMonth()+1),M:s=>s.getMonth()+1,DD:s=>jo(s.getDate()),D:s=>s.getDate(),WWWW:(s,e)=>e.WWWW[s.getDay()],WWW:(s,e)=>e.WWW[s.getDay()],HH:s=>jo(s.getHours()),H:s=>s.getHours(),h:s=>{let e=s.getHours();return e==0?12:e>12?e-12:e},AA:s=>s.getHours()>=12?"PM":"AM",aa:s=>s.getHours()>=12?"pm":"am",a:s=>s.getHours()>=12?"p":"a",mm:s=>jo(s.getMinutes()),m:s=>s.getMinutes(),ss:s=>jo(s.getSeconds()),s:s=>s.getSeconds(),fff:s=>dT(s.getMilliseconds())};function Cd(s,e){e=e||fT;let t=[],i=/\{([a-z]+)\}|[^{]+/gi,n;for(;n=i.exec(s);)t.push(n[0][0]=="{"?pT[n[1]]:n[0]);return r=>{let o="";for(let a=0;a<t.length;a++)o+=typeof t[a]=="string"?t[a]:t[a](r,e);return o}}var mT=new Intl.DateTimeFormat().resolvedOptions().timeZone;function gT(s,e){let t;return e=="UTC"||e=="Etc/UTC"?t=new Date(+s+s.getTimezoneOffset()*6e4):e==mT?t=s:(t=new Date(s.toLocaleString("en-US",{timeZone:e})),t.setMilliseconds(s.getMilliseconds())),t}var wy=s=>s%1==0,Sc=[1,2,2.5,5],xT=sa(10,-32,0,Sc),My=sa(10,0,32,Sc),vT=My.filter(wy),ks=xT.concat(My),Rd=`
`,Ay="{YYYY}",Gv=Rd+Ay,Ty="{M}/{D}",ta=Rd+Ty,xc=ta+"/{YY}",Ey="{aa}",yT="{h}:{mm}",Fr=yT+Ey,Wv=Rd+Fr,qv=":{ss}",Le=null;function Cy(s){let e=s*1e3,t=e*60,i=t*60,n=i*24,r=n*30,o=n*365,l=(s==1?sa(10,0,3,Sc).filter(wy):sa(10,-3,0,Sc)).concat([e,e*5,e*10,e*15,e*30,t,t*5,t*10,t*15,t*30,i,i*2,i*3,i*4,i*6,i*8,i*12,n,n*2,n*3,n*4,n*5,n*6,n*7,n*8,n*9,n*10,n*15,r,r*2,r*3,r*4,r*6,o,o*2,o*5,o*10,o*25,o*50,o*100]),c=[[o,Ay,Le,Le,Le,Le,Le,Le,1],[n*28,"{MMM}",Gv,Le,Le,Le,Le,Le,1],[n,Ty,Gv,Le,Le,Le,Le,Le,1],[i,"{h}"+Ey,xc,Le,ta,Le,Le,Le,1],[t,Fr,xc,Le,ta,Le,Le,Le,1],[e,qv,xc+" "+Fr,Le,ta+" "+Fr,Le,Wv,Le,1],[s,qv+".{fff}",xc+" "+Fr,Le,ta+" "+Fr,Le,Wv,Le,1]];function h(u){return(f,d,m,g,y,_)=>{let w=[],A=y>=o,T=y>=r&&y<o,C=u(m),E=Fe(C*s,3),P=ld(C.getFullYear(),A?0:C.getMonth(),T||A?1:C.getDate()),O=Fe(P*s,3);if(T||A){let H=T?y/r:0,G=A?y/o:0,k=E==O?E:Fe(ld(P.getFullYear()+G,P.getMonth()+H,1)*s,3),D=new Date(ft(k/s)),F=D.getFullYear(),V=D.getMonth();for(let N=0;k<=g;N++){let ie=ld(F+G*N,V+H*N,1),X=ie-u(Fe(ie*s,3));k=Fe((+ie+X)*s,3),k<=g&&w.push(k)}}else{let H=y>=n?n:y,G=ai(m)-ai(E),k=O+G+Ac(E-O,H);w.push(k);let D=u(k),F=D.getHours()+D.getMinutes()/t+D.getSeconds()/i,V=y/i,N=f.axes[d]._space,ie=_/N;for(;k=Fe(k+y,s==1?0:3),!(k>g);)if(V>1){let X=ai(Fe(F+V,6))%24,ae=u(k).getHours()-X;ae>1&&(ae=-1),k-=ae*i,F=(F+V)%24;let ue=w[w.length-1];Fe((k-ue)/y,3)*ie>=.7&&w.push(k)}else w.push(k)}return w}}return[l,c,h]}var[bT,_T,ST]=Cy(1),[wT,MT,AT]=Cy(.001);sa(2,-53,53,[1]);function Xv(s,e){return s.map(t=>t.map((i,n)=>n==0||n==8||i==null?i:e(n==1||t[8]==0?i:t[1]+i)))}function $v(s,e){return(t,i,n,r,o)=>{let a=e.find(m=>o>=m[0])||e[e.length-1],l,c,h,u,f,d;return i.map(m=>{let g=s(m),y=g.getFullYear(),_=g.getMonth(),w=g.getDate(),A=g.getHours(),T=g.getMinutes(),C=g.getSeconds(),E=y!=l&&a[2]||_!=c&&a[3]||w!=h&&a[4]||A!=u&&a[5]||T!=f&&a[6]||C!=d&&a[7]||a[1];return l=y,c=_,h=w,u=A,f=T,d=C,E(g)})}}function TT(s,e){let t=Cd(e);return(i,n,r,o,a)=>n.map(l=>t(s(l)))}function ld(s,e,t){return new Date(s,e,t)}function Yv(s,e){return e(s)}var ET="{YYYY}-{MM}-{DD} {h}:{mm}{aa}";function Kv(s,e){return(t,i,n,r)=>r==null?Sd:e(s(i))}function CT(s,e){let t=s.series[e];return t.width?t.stroke(s,e):t.points.width?t.points.stroke(s,e):null}function RT(s,e){return s.series[e].fill(s,e)}var PT={show:!0,live:!0,isolate:!1,mount:KA,markers:{show:!0,width:2,stroke:CT,fill:RT,dash:"solid"},idx:null,idxs:null,values:[]};function kT(s,e){let t=s.cursor.points,i=Ti(),n=t.size(s,e);qe(i,Qo,n),qe(i,ea,n);let r=n/-2;qe(i,"marginLeft",r),qe(i,"marginTop",r);let o=t.width(s,e,n);return o&&qe(i,"borderWidth",o),i}function LT(s,e){let t=s.series[e].points;return t._fill||t._stroke}function IT(s,e){let t=s.series[e].points;return t._stroke||t._fill}function DT(s,e){return s.series[e].points.size}var cd=[0,0];function NT(s,e,t){return cd[0]=e,cd[1]=t,cd}function vc(s,e,t,i=!0){return n=>{n.button==0&&(!i||n.target==e)&&t(n)}}function hd(s,e,t,i=!0){return n=>{(!i||n.target==e)&&t(n)}}var OT={show:!0,x:!0,y:!0,lock:!1,move:NT,points:{one:!1,show:kT,size:DT,width:0,stroke:IT,fill:LT},bind:{mousedown:vc,mouseup:vc,click:vc,dblclick:vc,mousemove:hd,mouseleave:hd,mouseenter:hd},drag:{setScale:!0,x:!0,y:!1,dist:0,uni:null,click:(s,e)=>{e.stopPropagation(),e.stopImmediatePropagation()},_x:!1,_y:!1},focus:{dist:(s,e,t,i,n)=>i-n,prox:-1,bias:0},hover:{skip:[void 0],prox:null,bias:0},left:-10,top:-10,idx:null,dataIdx:null,idxs:null,event:null},Ry={show:!0,stroke:"rgba(0,0,0,0.07)",width:2},Pd=lt({},Ry,{filter:my}),Py=lt({},Pd,{size:10}),ky=lt({},Ry,{show:!1}),kd='12px system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, "Noto Sans", sans-serif, "Apple Color Emoji", "Segoe UI Emoji", "Segoe UI Symbol", "Noto Color Emoji"',Ly="bold "+kd,Iy=1.5,Jv={show:!0,scale:"x",stroke:_d,space:50,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:Ly,side:2,grid:Pd,ticks:Py,border:ky,font:kd,lineGap:Iy,rotate:0},FT="Value",BT="Time",Zv={show:!0,scale:"x",auto:!1,sorted:1,min:Oe,max:-Oe,idxs:[]};function UT(s,e,t,i,n){return e.map(r=>r==null?"":Td(r))}function zT(s,e,t,i,n,r,o){let a=[],l=$n.get(n)||0;t=o?t:Fe(Ac(t,n),l);for(let c=t;c<=i;c=Fe(c+n,l))a.push(Object.is(c,-0)?0:c);return a}function gd(s,e,t,i,n,r,o){let a=[],l=s.scales[s.axes[e].scale].log,c=l==10?_n:fy,h=ai(c(t));n=Ur(l,h),l==10&&(n=ks[qi(n,ks)]);let u=t,f=n*l;l==10&&(f=ks[qi(f,ks)]);do a.push(u),u=u+n,l==10&&!$n.has(u)&&(u=Fe(u,$n.get(n))),u>=f&&(n=u,f=n*l,l==10&&(f=ks[qi(f,ks)]));while(u<=i);return a}function VT(s,e,t,i,n,r,o){let l=s.scales[s.axes[e].scale].asinh,c=i>l?gd(s,e,Gt(l,t),i,n):[l],h=i>=0&&t<=0?[0]:[];return(t<-l?gd(s,e,Gt(l,-i),-t,n):[l]).reverse().map(f=>-f).concat(h,c)}var Dy=/./,HT=/[12357]/,GT=/[125]/,jv=/1/,xd=(s,e,t,i)=>s.map((n,r)=>e==4&&n==0||r%i==0&&t.test(n.toExponential()[n<0?1:0])?n:null);function WT(s,e,t,i,n){let r=s.axes[t],o=r.scale,a=s.scales[o],l=s.valToPos,c=r._space,h=l(10,o),u=l(9,o)-h>=c?Dy:l(7,o)-h>=c?HT:l(5,o)-h>=c?GT:jv;if(u==jv){let f=dt(l(1,o)-h);if(f<c)return xd(e.slice().reverse(),a.distr,u,Ei(c/f)).reverse()}return xd(e,a.distr,u,1)}function qT(s,e,t,i,n){let r=s.axes[t],o=r.scale,a=r._space,l=s.valToPos,c=dt(l(1,o)-l(2,o));return c<a?xd(e.slice().reverse(),3,Dy,Ei(a/c)).reverse():e}function XT(s,e,t,i){return i==null?Sd:e==null?"":Td(e)}var Qv={show:!0,scale:"y",stroke:_d,space:30,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:Ly,side:3,grid:Pd,ticks:Py,border:ky,font:kd,lineGap:Iy,rotate:0};function $T(s,e){let t=3+(s||1)*2;return Fe(t*e,3)}function YT(s,e){let{scale:t,idxs:i}=s.series[0],n=s._data[0],r=s.valToPos(n[i[0]],t,!0),o=s.valToPos(n[i[1]],t,!0),a=dt(o-r),l=s.series[e],c=a/(l.points.space*Re);return i[1]-i[0]<=c}var ey={scale:null,auto:!0,sorted:0,min:Oe,max:-Oe},Ny=(s,e,t,i,n)=>n,ty={show:!0,auto:!0,sorted:0,gaps:Ny,alpha:1,facets:[lt({},ey,{scale:"x"}),lt({},ey,{scale:"y"})]},iy={scale:"y",auto:!0,sorted:0,show:!0,spanGaps:!1,gaps:Ny,alpha:1,points:{show:YT,filter:null},values:null,min:Oe,max:-Oe,idxs:[],path:null,clip:null};function KT(s,e,t,i,n){return t/10}var Oy={time:!0,auto:!0,distr:1,log:10,asinh:1,min:null,max:null,dir:1,ori:0},JT=lt({},Oy,{time:!1,ori:1}),ny={};function Fy(s,e){let t=ny[s];return t||(t={key:s,plots:[],sub(i){t.plots.push(i)},unsub(i){t.plots=t.plots.filter(n=>n!=i)},pub(i,n,r,o,a,l,c){for(let h=0;h<t.plots.length;h++)t.plots[h]!=n&&t.plots[h].pub(i,n,r,o,a,l,c)}},s!=null&&(ny[s]=t)),t}var Hr=1,vd=2;function Ns(s,e,t){let i=s.mode,n=s.series[e],r=i==2?s._data[e]:s._data,o=s.scales,a=s.bbox,l=r[0],c=i==2?r[1]:r[e],h=i==2?o[n.facets[0].scale]:o[s.series[0].scale],u=i==2?o[n.facets[1].scale]:o[n.scale],f=a.left,d=a.top,m=a.width,g=a.height,y=s.valToPosH,_=s.valToPosV;return h.ori==0?t(n,l,c,h,u,y,_,f,d,m,g,Cc,Wr,Pc,Uy,Vy):t(n,l,c,h,u,_,y,d,f,g,m,Rc,qr,Dd,zy,Hy)}function Ld(s,e){let t=0,i=0,n=Te(s.bands,Ed);for(let r=0;r<n.length;r++){let o=n[r];o.series[0]==e?t=o.dir:o.series[1]==e&&(o.dir==1?i|=1:i|=2)}return[t,i==1?-1:i==2?1:i==3?2:0]}function ZT(s,e,t,i,n){let r=s.mode,o=s.series[e],a=r==2?o.facets[1].scale:o.scale,l=s.scales[a];return n==-1?l.min:n==1?l.max:l.distr==3?l.dir==1?l.min:l.max:0}function Sn(s,e,t,i,n,r){return Ns(s,e,(o,a,l,c,h,u,f,d,m,g,y)=>{let _=o.pxRound,w=c.dir*(c.ori==0?1:-1),A=c.ori==0?Wr:qr,T,C;w==1?(T=t,C=i):(T=i,C=t);let E=_(u(a[T],c,g,d)),P=_(f(l[T],h,y,m)),O=_(u(a[C],c,g,d)),H=_(f(r==1?h.max:h.min,h,y,m)),G=new Path2D(n);return A(G,O,H),A(G,E,H),A(G,E,P),G})}function Ec(s,e,t,i,n,r){let o=null;if(s.length>0){o=new Path2D;let a=e==0?Pc:Dd,l=t;for(let u=0;u<s.length;u++){let f=s[u];if(f[1]>f[0]){let d=f[0]-l;d>0&&a(o,l,i,d,i+r),l=f[1]}}let c=t+n-l,h=10;c>0&&a(o,l,i-h/2,c,i+r+h)}return o}function jT(s,e,t){let i=s[s.length-1];i&&i[0]==e?i[1]=t:s.push([e,t])}function Id(s,e,t,i,n,r,o){let a=[],l=s.length;for(let c=n==1?t:i;c>=t&&c<=i;c+=n)if(e[c]===null){let u=c,f=c;if(n==1)for(;++c<=i&&e[c]===null;)f=c;else for(;--c>=t&&e[c]===null;)f=c;let d=r(s[u]),m=f==u?d:r(s[f]),g=u-n;d=o<=0&&g>=0&&g<l?r(s[g]):d;let _=f+n;m=o>=0&&_>=0&&_<l?r(s[_]):m,m>=d&&a.push([d,m])}return a}function sy(s){return s==0?py:s==1?ft:e=>Ps(e,s)}function By(s){let e=s==0?Cc:Rc,t=s==0?(n,r,o,a,l,c)=>{n.arcTo(r,o,a,l,c)}:(n,r,o,a,l,c)=>{n.arcTo(o,r,l,a,c)},i=s==0?(n,r,o,a,l)=>{n.rect(r,o,a,l)}:(n,r,o,a,l)=>{n.rect(o,r,l,a)};return(n,r,o,a,l,c=0,h=0)=>{c==0&&h==0?i(n,r,o,a,l):(c=Xi(c,a/2,l/2),h=Xi(h,a/2,l/2),e(n,r+c,o),t(n,r+a,o,r+a,o+l,c),t(n,r+a,o+l,r,o+l,h),t(n,r,o+l,r,o,h),t(n,r,o,r+a,o,c),n.closePath())}}var Cc=(s,e,t)=>{s.moveTo(e,t)},Rc=(s,e,t)=>{s.moveTo(t,e)},Wr=(s,e,t)=>{s.lineTo(e,t)},qr=(s,e,t)=>{s.lineTo(t,e)},Pc=By(0),Dd=By(1),Uy=(s,e,t,i,n,r)=>{s.arc(e,t,i,n,r)},zy=(s,e,t,i,n,r)=>{s.arc(t,e,i,n,r)},Vy=(s,e,t,i,n,r,o)=>{s.bezierCurveTo(e,t,i,n,r,o)},Hy=(s,e,t,i,n,r,o)=>{s.bezierCurveTo(t,e,n,i,o,r)};function Gy(s){return(e,t,i,n,r)=>Ns(e,t,(o,a,l,c,h,u,f,d,m,g,y)=>{let{pxRound:_,points:w}=o,A,T;c.ori==0?(A=Cc,T=Uy):(A=Rc,T=zy);let C=Fe(w.width*Re,3),E=(w.size-w.width)/2*Re,P=Fe(E*2,3),O=new Path2D,H=new Path2D,{left:G,top:k,width:D,height:F}=e.bbox;Pc(H,G-P,k-P,D+P*2,F+P*2);let V=N=>{if(l[N]!=null){let ie=_(u(a[N],c,g,d)),X=_(f(l[N],h,y,m));A(O,ie+E,X),T(O,ie,X,E,0,yc*2)}};if(r)r.forEach(V);else for(let N=i;N<=n;N++)V(N);return{stroke:C>0?O:null,fill:O,clip:H,flags:Hr|vd}})}function Wy(s){return(e,t,i,n,r,o)=>{i!=n&&(r!=i&&o!=i&&s(e,t,i),r!=n&&o!=n&&s(e,t,n),s(e,t,o))}}var QT=Wy(Wr),eE=Wy(qr);function qy(s){let e=Te(s?.alignGaps,0);return(t,i,n,r)=>Ns(t,i,(o,a,l,c,h,u,f,d,m,g,y)=>{[n,r]=wc(l,n,r);let _=o.pxRound,w=F=>_(u(F,c,g,d)),A=F=>_(f(F,h,y,m)),T,C;c.ori==0?(T=Wr,C=QT):(T=qr,C=eE);let E=c.dir*(c.ori==0?1:-1),P={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:Hr},O=P.stroke,H=!1;if(r-n>=g*4){let F=j=>t.posToVal(j,c.key,!0),V=null,N=null,ie,X,Pe,ce=w(a[E==1?n:r]),ae=w(a[n]),ue=w(a[r]),se=F(E==1?ae+1:ue-1);for(let j=E==1?n:r;j>=n&&j<=r;j+=E){let ke=a[j],Ee=(E==1?ke<se:ke>se)?ce:w(ke),xe=l[j];Ee==ce?xe!=null?(X=xe,V==null?(T(O,Ee,A(X)),ie=V=N=X):X<V?V=X:X>N&&(N=X)):xe===null&&(H=!0):(V!=null&&C(O,ce,A(V),A(N),A(ie),A(X)),xe!=null?(X=xe,T(O,Ee,A(X)),V=N=ie=X):(V=N=null,xe===null&&(H=!0)),ce=Ee,se=F(ce+E))}V!=null&&V!=N&&Pe!=ce&&C(O,ce,A(V),A(N),A(ie),A(X))}else for(let F=E==1?n:r;F>=n&&F<=r;F+=E){let V=l[F];V===null?H=!0:V!=null&&T(O,w(a[F]),A(V))}let[k,D]=Ld(t,i);if(o.fill!=null||k!=0){let F=P.fill=new Path2D(O),V=o.fillTo(t,i,o.min,o.max,k),N=A(V),ie=w(a[n]),X=w(a[r]);E==-1&&([X,ie]=[ie,X]),T(F,X,N),T(F,ie,N)}if(!o.spanGaps){let F=[];H&&F.push(...Id(a,l,n,r,E,w,e)),P.gaps=F=o.gaps(t,i,n,r,F),P.clip=Ec(F,c.ori,d,m,g,y)}return D!=0&&(P.band=D==2?[Sn(t,i,n,r,O,-1),Sn(t,i,n,r,O,1)]:Sn(t,i,n,r,O,D)),P})}function tE(s){let e=Te(s.align,1),t=Te(s.ascDesc,!1),i=Te(s.alignGaps,0),n=Te(s.extend,!1);return(r,o,a,l)=>Ns(r,o,(c,h,u,f,d,m,g,y,_,w,A)=>{[a,l]=wc(u,a,l);let T=c.pxRound,{left:C,width:E}=r.bbox,P=ae=>T(m(ae,f,w,y)),O=ae=>T(g(ae,d,A,_)),H=f.ori==0?Wr:qr,G={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:Hr},k=G.stroke,D=f.dir*(f.ori==0?1:-1),F=O(u[D==1?a:l]),V=P(h[D==1?a:l]),N=V,ie=V;n&&e==-1&&(ie=C,H(k,ie,F)),H(k,V,F);for(let ae=D==1?a:l;ae>=a&&ae<=l;ae+=D){let ue=u[ae];if(ue==null)continue;let se=P(h[ae]),j=O(ue);e==1?H(k,se,F):H(k,N,j),H(k,se,j),F=j,N=se}let X=N;n&&e==1&&(X=C+E,H(k,X,F));let[Pe,ce]=Ld(r,o);if(c.fill!=null||Pe!=0){let ae=G.fill=new Path2D(k),ue=c.fillTo(r,o,c.min,c.max,Pe),se=O(ue);H(ae,X,se),H(ae,ie,se)}if(!c.spanGaps){let ae=[];ae.push(...Id(h,u,a,l,D,P,i));let ue=c.width*Re/2,se=t||e==1?ue:-ue,j=t||e==-1?-ue:ue;ae.forEach(ke=>{ke[0]+=se,ke[1]+=j}),G.gaps=ae=c.gaps(r,o,a,l,ae),G.clip=Ec(ae,f.ori,y,_,w,A)}return ce!=0&&(G.band=ce==2?[Sn(r,o,a,l,k,-1),Sn(r,o,a,l,k,1)]:Sn(r,o,a,l,k,ce)),G})}function ry(s,e,t,i,n,r,o=Oe){if(s.length>1){let a=null;for(let l=0,c=1/0;l<s.length;l++)if(e[l]!==void 0){if(a!=null){let h=dt(s[l]-s[a]);h<c&&(c=h,o=dt(t(s[l],i,n,r)-t(s[a],i,n,r)))}a=l}}return o}function iE(s){s=s||na;let e=Te(s.size,[.6,Oe,1]),t=s.align||0,i=s.gap||0,n=s.radius;n=n==null?[0,0]:typeof n=="number"?[n,0]:n;let r=ve(n),o=1-e[0],a=Te(e[1],Oe),l=Te(e[2],1),c=Te(s.disp,na),h=Te(s.each,d=>{}),{fill:u,stroke:f}=c;return(d,m,g,y)=>Ns(d,m,(_,w,A,T,C,E,P,O,H,G,k)=>{let D=_.pxRound,F=t,V=i*Re,N=a*Re,ie=l*Re,X,Pe;T.ori==0?[X,Pe]=r(d,m):[Pe,X]=r(d,m);let ce=T.dir*(T.ori==0?1:-1),ae=T.ori==0?Pc:Dd,ue=T.ori==0?h:(Q,Be,ct,Hs,ts,Ji,is)=>{h(Q,Be,ct,ts,Hs,is,Ji)},se=Te(d.bands,Ed).find(Q=>Q.series[0]==m),j=se!=null?se.dir:0,ke=_.fillTo(d,m,_.min,_.max,j),Ve=D(P(ke,C,k,H)),Ee,xe,qt,Kt=G,Ze=D(_.width*Re),Ki=!1,fn=null,ui=null,En=null,Us=null;u!=null&&(Ze==0||f!=null)&&(Ki=!0,fn=u.values(d,m,g,y),ui=new Map,new Set(fn).forEach(Q=>{Q!=null&&ui.set(Q,new Path2D)}),Ze>0&&(En=f.values(d,m,g,y),Us=new Map,new Set(En).forEach(Q=>{Q!=null&&Us.set(Q,new Path2D)})));let{x0:zs,size:eo}=c;if(zs!=null&&eo!=null){F=1,w=zs.values(d,m,g,y),zs.unit==2&&(w=w.map(ct=>d.posToVal(O+ct*G,T.key,!0)));let Q=eo.values(d,m,g,y);eo.unit==2?xe=Q[0]*G:xe=E(Q[0],T,G,O)-E(0,T,G,O),Kt=ry(w,A,E,T,G,O,Kt),qt=Kt-xe+V}else Kt=ry(w,A,E,T,G,O,Kt),qt=Kt*o+V,xe=Kt-qt;qt<1&&(qt=0),Ze>=xe/2&&(Ze=0),qt<5&&(D=py);let fa=qt>0,Qn=Kt-qt-(fa?Ze:0);xe=D(md(Qn,ie,N)),Ee=(F==0?xe/2:F==ce?0:xe)-F*ce*((F==0?V/2:0)+(fa?Ze/2:0));let Dt={stroke:null,fill:null,clip:null,band:null,gaps:null,flags:0},Vs=Ki?null:new Path2D,dn=null;if(se!=null)dn=d.data[se.series[1]];else{let{y0:Q,y1:Be}=c;Q!=null&&Be!=null&&(A=Be.values(d,m,g,y),dn=Q.values(d,m,g,y))}let es=X*xe,fe=Pe*xe;for(let Q=ce==1?g:y;Q>=g&&Q<=y;Q+=ce){let Be=A[Q];if(Be==null)continue;if(dn!=null){let Xt=dn[Q]??0;if(Be-Xt==0)continue;Ve=P(Xt,C,k,H)}let ct=T.distr!=2||c!=null?w[Q]:Q,Hs=E(ct,T,G,O),ts=P(Te(Be,ke),C,k,H),Ji=D(Hs-Ee),is=D(Gt(ts,Ve)),Jt=D(Xi(ts,Ve)),fi=is-Jt;if(Be!=null){let Xt=Be<0?fe:es,Pi=Be<0?es:fe;Ki?(Ze>0&&En[Q]!=null&&ae(Us.get(En[Q]),Ji,Jt+ai(Ze/2),xe,Gt(0,fi-Ze),Xt,Pi),fn[Q]!=null&&ae(ui.get(fn[Q]),Ji,Jt+ai(Ze/2),xe,Gt(0,fi-Ze),Xt,Pi)):ae(Vs,Ji,Jt+ai(Ze/2),xe,Gt(0,fi-Ze),Xt,Pi),ue(d,m,Q,Ji-Ze/2,Jt,xe+Ze,fi)}}return Ze>0?Dt.stroke=Ki?Us:Vs:Ki||(Dt._fill=_.width==0?_._fill:_._stroke??_._fill,Dt.width=0),Dt.fill=Ki?ui:Vs,Dt})}function nE(s,e){let t=Te(e?.alignGaps,0);return(i,n,r,o)=>Ns(i,n,(a,l,c,h,u,f,d,m,g,y,_)=>{[r,o]=wc(c,r,o);let w=a.pxRound,A=X=>w(f(X,h,y,m)),T=X=>w(d(X,u,_,g)),C,E,P;h.ori==0?(C=Cc,P=Wr,E=Vy):(C=Rc,P=qr,E=Hy);let O=h.dir*(h.ori==0?1:-1),H=A(l[O==1?r:o]),G=H,k=[],D=[];for(let X=O==1?r:o;X>=r&&X<=o;X+=O)if(c[X]!=null){let ce=l[X],ae=A(ce);k.push(G=ae),D.push(T(c[X]))}let F={stroke:s(k,D,C,P,E,w),fill:null,clip:null,band:null,gaps:null,flags:Hr},V=F.stroke,[N,ie]=Ld(i,n);if(a.fill!=null||N!=0){let X=F.fill=new Path2D(V),Pe=a.fillTo(i,n,a.min,a.max,N),ce=T(Pe);P(X,G,ce),P(X,H,ce)}if(!a.spanGaps){let X=[];X.push(...Id(l,c,r,o,O,A,t)),F.gaps=X=a.gaps(i,n,r,o,X),F.clip=Ec(X,h.ori,m,g,y,_)}return ie!=0&&(F.band=ie==2?[Sn(i,n,r,o,V,-1),Sn(i,n,r,o,V,1)]:Sn(i,n,r,o,V,ie)),F})}function sE(s){return nE(rE,s)}function rE(s,e,t,i,n,r){let o=s.length;if(o<2)return null;let a=new Path2D;if(t(a,s[0],e[0]),o==2)i(a,s[1],e[1]);else{let l=Array(o),c=Array(o-1),h=Array(o-1),u=Array(o-1);for(let f=0;f<o-1;f++)h[f]=e[f+1]-e[f],u[f]=s[f+1]-s[f],c[f]=h[f]/u[f];l[0]=c[0];for(let f=1;f<o-1;f++)c[f]===0||c[f-1]===0||c[f-1]>0!=c[f]>0?l[f]=0:(l[f]=3*(u[f-1]+u[f])/((2*u[f]+u[f-1])/c[f-1]+(u[f]+2*u[f-1])/c[f]),isFinite(l[f])||(l[f]=0));l[o-1]=c[o-2];for(let f=0;f<o-1;f++)n(a,s[f]+u[f]/3,e[f]+l[f]*u[f]/3,s[f+1]-u[f]/3,e[f+1]-l[f+1]*u[f]/3,s[f+1],e[f+1])}return a}var yd=new Set;function oy(){for(let s of yd)s.syncRect(!0)}Gr&&(Is(UA,Br,oy),Is(zA,Br,oy,!0),Is(bc,Br,()=>{Et.pxRatio=Re}));var oE=qy(),aE=Gy();function ay(s,e,t,i){return(i?[s[0],s[1]].concat(s.slice(2)):[s[0]].concat(s.slice(1))).map((r,o)=>bd(r,o,e,t))}function lE(s,e){return s.map((t,i)=>i==0?{}:lt({},e,t))}function bd(s,e,t,i){return lt({},e==0?t:i,s)}function Xy(s,e,t){return e==null?zr:[e,t]}var cE=Xy;function hE(s,e,t){return e==null?zr:_c(e,t,Ad,!0)}function $y(s,e,t,i){return e==null?zr:Mc(e,t,s.scales[i].log,!1)}var uE=$y;function Yy(s,e,t,i){return e==null?zr:Md(e,t,s.scales[i].log,!1)}var fE=Yy;function dE(s,e,t,i,n){let r=Gt(Uv(s),Uv(e)),o=e-s,a=qi(n/i*o,t);do{let l=t[a],c=i*l/o;if(c>=n&&r+(l<5?$n.get(l):0)<=17)return[l,c]}while(++a<t.length);return[0,0]}function ly(s){let e,t;return s=s.replace(/(\d+)px/,(i,n)=>(e=ft((t=+n)*Re))+"px"),[s,e,t]}function pE(s){s.show&&[s.font,s.labelFont].forEach(e=>{let t=Fe(e[2]*Re,1);e[0]=e[0].replace(/[0-9.]+px/,t+"px"),e[1]=t})}function Et(s,e,t){let i={mode:Te(s.mode,1)},n=i.mode;function r(p,x,v,b){let M=x.valToPct(p);return b+v*(x.dir==-1?1-M:M)}function o(p,x,v,b){let M=x.valToPct(p);return b+v*(x.dir==-1?M:1-M)}function a(p,x,v,b){return x.ori==0?r(p,x,v,b):o(p,x,v,b)}i.valToPosH=r,i.valToPosV=o;let l=!1;i.status=0;let c=i.root=Ti(_A);if(s.id!=null&&(c.id=s.id),oi(c,s.class),s.title){let p=Ti(MA,c);p.textContent=s.title}let h=Wi("canvas"),u=i.ctx=h.getContext("2d"),f=Ti(AA,c);Is("click",f,p=>{p.target===m&&(He!=Qs||$e!=er)&&At.click(i,p)},!0);let d=i.under=Ti(TA,f);f.appendChild(h);let m=i.over=Ti(EA,f);s=Vr(s);let g=+Te(s.pxAlign,1),y=sy(g);(s.plugins||[]).forEach(p=>{p.opts&&(s=p.opts(i,s)||s)});let _=s.ms||.001,w=i.series=n==1?ay(s.series||[],Zv,iy,!1):lE(s.series||[null],ty),A=i.axes=ay(s.axes||[],Jv,Qv,!0),T=i.scales={},C=i.bands=s.bands||[];C.forEach(p=>{p.fill=ve(p.fill||null),p.dir=Te(p.dir,-1)});let E=n==2?w[1].facets[0].scale:w[0].scale,P={axes:$b,series:Hb},O=(s.drawOrder||["axes","series"]).map(p=>P[p]);function H(p){let x=p.distr==3?v=>_n(v>0?v:p.clamp(i,v,p.min,p.max,p.key)):p.distr==4?v=>ad(v,p.asinh):p.distr==100?v=>p.fwd(v):v=>v;return v=>{let b=x(v),{_min:M,_max:R}=p,L=R-M;return(b-M)/L}}function G(p){let x=T[p];if(x==null){let v=(s.scales||na)[p]||na;if(v.from!=null){G(v.from);let b=lt({},T[v.from],v,{key:p});b.valToPct=H(b),T[p]=b}else{x=T[p]=lt({},p==E?Oy:JT,v),x.key=p;let b=x.time,M=x.range,R=Xn(M);if((p!=E||n==2&&!b)&&(R&&(M[0]==null||M[1]==null)&&(M={min:M[0]==null?Ov:{mode:1,hard:M[0],soft:M[0]},max:M[1]==null?Ov:{mode:1,hard:M[1],soft:M[1]}},R=!1),!R&&Tc(M))){let L=M;M=(B,U,Y)=>U==null?zr:_c(U,Y,L)}x.range=ve(M||(b?cE:p==E?x.distr==3?uE:x.distr==4?fE:Xy:x.distr==3?$y:x.distr==4?Yy:hE)),x.auto=ve(R?!1:x.auto),x.clamp=ve(x.clamp||KT),x._min=x._max=null,x.valToPct=H(x)}}}G("x"),G("y"),n==1&&w.forEach(p=>{G(p.scale)}),A.forEach(p=>{G(p.scale)});for(let p in s.scales)G(p);let k=T[E],D=k.distr,F,V;k.ori==0?(oi(c,SA),F=r,V=o):(oi(c,wA),F=o,V=r);let N={};for(let p in T){let x=T[p];(x.min!=null||x.max!=null)&&(N[p]={min:x.min,max:x.max},x.min=x.max=null)}let ie=s.tzDate||(p=>new Date(ft(p/_))),X=s.fmtDate||Cd,Pe=_==1?ST(ie):AT(ie),ce=$v(ie,Xv(_==1?_T:MT,X)),ae=Kv(ie,Yv(ET,X)),ue=[],se=i.legend=lt({},PT,s.legend),j=i.cursor=lt({},OT,{drag:{y:n==2}},s.cursor),ke=se.show,Ve=j.show,Ee=se.markers;se.idxs=ue,Ee.width=ve(Ee.width),Ee.dash=ve(Ee.dash),Ee.stroke=ve(Ee.stroke),Ee.fill=ve(Ee.fill);let xe,qt,Kt,Ze=[],Ki=[],fn,ui=!1,En={};if(se.live){let p=w[1]?w[1].values:null;ui=p!=null,fn=ui?p(i,1,0):{_:0};for(let x in fn)En[x]=Sd}if(ke)if(xe=Wi("table",IA,c),Kt=Wi("tbody",null,xe),se.mount(i,xe),ui){qt=Wi("thead",null,xe,Kt);let p=Wi("tr",null,qt);Wi("th",null,p);for(var Us in fn)Wi("th",wv,p).textContent=Us}else oi(xe,NA),se.live&&oi(xe,DA);let zs={show:!0},eo={show:!1};function fa(p,x){if(x==0&&(ui||!se.live||n==2))return zr;let v=[],b=Wi("tr",OA,Kt,Kt.childNodes[x]);oi(b,p.class),p.show||oi(b,Ls);let M=Wi("th",null,b);if(Ee.show){let B=Ti(FA,M);if(x>0){let U=Ee.width(i,x);U&&(B.style.border=U+"px "+Ee.dash(i,x)+" "+Ee.stroke(i,x)),B.style.background=Ee.fill(i,x)}}let R=Ti(wv,M);p.label instanceof HTMLElement?R.appendChild(p.label):R.textContent=p.label,x>0&&(Ee.show||(R.style.color=p.width>0?Ee.stroke(i,x):Ee.fill(i,x)),Dt("click",M,B=>{if(j._lock)return;ss(B);let U=w.indexOf(p);if((B.ctrlKey||B.metaKey)!=se.isolate){let Y=w.some((Z,te)=>te>0&&te!=U&&Z.show);w.forEach((Z,te)=>{te>0&&ji(te,Y?te==U?zs:eo:zs,!0,st.setSeries)})}else ji(U,{show:!p.show},!0,st.setSeries)},!1),Ws&&Dt(Ev,M,B=>{j._lock||(ss(B),ji(w.indexOf(p),ir,!0,st.setSeries))},!1));for(var L in fn){let B=Wi("td",BA,b);B.textContent="--",v.push(B)}return[b,v]}let Qn=new Map;function Dt(p,x,v,b=!0){let M=Qn.get(x)||{},R=j.bind[p](i,x,v,b);R&&(Is(p,x,M[p]=R),Qn.set(x,M))}function Vs(p,x,v){let b=Qn.get(x)||{};for(let M in b)(p==null||M==p)&&(pd(M,x,b[M]),delete b[M]);p==null&&Qn.delete(x)}let dn=0,es=0,fe=0,Q=0,Be=0,ct=0,Hs=Be,ts=ct,Ji=fe,is=Q,Jt=0,fi=0,Xt=0,Pi=0;i.bbox={};let ih=!1,da=!1,Gs=!1,ns=!1,pa=!1,di=!1;function nh(p,x,v){(v||p!=i.width||x!=i.height)&&Ap(p,x),Ks(!1),Gs=!0,da=!0,Js()}function Ap(p,x){i.width=dn=fe=p,i.height=es=Q=x,Be=ct=0,Nb(),Ob();let v=i.bbox;Jt=v.left=Ps(Be*Re,.5),fi=v.top=Ps(ct*Re,.5),Xt=v.width=Ps(fe*Re,.5),Pi=v.height=Ps(Q*Re,.5)}let Lb=3;function Ib(){let p=!1,x=0;for(;!p;){x++;let v=qb(x),b=Xb(x);p=x==Lb||v&&b,p||(Ap(i.width,i.height),da=!0)}}function Db({width:p,height:x}){nh(p,x)}i.setSize=Db;function Nb(){let p=!1,x=!1,v=!1,b=!1;A.forEach((M,R)=>{if(M.show&&M._show){let{side:L,_size:B}=M,U=L%2,Y=M.label!=null?M.labelSize:0,Z=B+Y;Z>0&&(U?(fe-=Z,L==3?(Be+=Z,b=!0):v=!0):(Q-=Z,L==0?(ct+=Z,p=!0):x=!0))}}),rs[0]=p,rs[1]=v,rs[2]=x,rs[3]=b,fe-=Cn[1]+Cn[3],Be+=Cn[3],Q-=Cn[2]+Cn[0],ct+=Cn[0]}function Ob(){let p=Be+fe,x=ct+Q,v=Be,b=ct;function M(R,L){switch(R){case 1:return p+=L,p-L;case 2:return x+=L,x-L;case 3:return v-=L,v+L;case 0:return b-=L,b+L}}A.forEach((R,L)=>{if(R.show&&R._show){let B=R.side;R._pos=M(B,R._size),R.label!=null&&(R._lpos=M(B,R.labelSize))}})}if(j.dataIdx==null){let p=j.hover,x=p.skip=new Set(p.skip??[]);x.add(void 0);let v=p.prox=ve(p.prox),b=p.bias??=0;j.dataIdx=(M,R,L,B)=>{if(R==0)return L;let U=L,Y=v(M,R,L,B)??Oe,Z=Y>=0&&Y<Oe,te=k.ori==0?fe:Q,he=j.left,Ce=e[0],Se=e[R];if(x.has(Se[L])){U=null;let ge=null,le=null,ne;if(b==0||b==-1)for(ne=L;ge==null&&ne-- >0;)x.has(Se[ne])||(ge=ne);if(b==0||b==1)for(ne=L;le==null&&ne++<Se.length;)x.has(Se[ne])||(le=ne);if(ge!=null||le!=null)if(Z){let We=ge==null?-1/0:F(Ce[ge],k,te,0),Qe=le==null?1/0:F(Ce[le],k,te,0),yt=he-We,De=Qe-he;yt<=De?yt<=Y&&(U=ge):De<=Y&&(U=le)}else U=le==null?ge:ge==null?le:L-ge<=le-L?ge:le}else Z&&dt(he-F(Ce[L],k,te,0))>Y&&(U=null);return U}}let ss=p=>{j.event=p};j.idxs=ue,j._lock=!1;let Ct=j.points;Ct.show=ve(Ct.show),Ct.size=ve(Ct.size),Ct.stroke=ve(Ct.stroke),Ct.width=ve(Ct.width),Ct.fill=ve(Ct.fill);let Zi=i.focus=lt({},s.focus||{alpha:.3},j.focus),Ws=Zi.prox>=0,qs=Ws&&Ct.one,pi=[],Xs=[],$s=[];function Tp(p,x){let v=Ct.show(i,x);if(v instanceof HTMLElement)return oi(v,LA),oi(v,p.class),un(v,-10,-10,fe,Q),m.insertBefore(v,pi[x]),v}function Ep(p,x){if(n==1||x>0){let v=n==1&&T[p.scale].time,b=p.value;p.value=v?Hv(b)?Kv(ie,Yv(b,X)):b||ae:b||XT,p.label=p.label||(v?BT:FT)}if(qs||x>0){p.width=p.width==null?1:p.width,p.paths=p.paths||oE||JA,p.fillTo=ve(p.fillTo||ZT),p.pxAlign=+Te(p.pxAlign,g),p.pxRound=sy(p.pxAlign),p.stroke=ve(p.stroke||null),p.fill=ve(p.fill||null),p._stroke=p._fill=p._paths=p._focus=null;let v=$T(Gt(1,p.width),1),b=p.points=lt({},{size:v,width:Gt(1,v*.2),stroke:p.stroke,space:v*2,paths:aE,_stroke:null,_fill:null},p.points);b.show=ve(b.show),b.filter=ve(b.filter),b.fill=ve(b.fill),b.stroke=ve(b.stroke),b.paths=ve(b.paths),b.pxAlign=p.pxAlign}if(ke){let v=fa(p,x);Ze.splice(x,0,v[0]),Ki.splice(x,0,v[1]),se.values.push(null)}if(Ve){ue.splice(x,0,null);let v=null;qs?x==0&&(v=Tp(p,x)):x>0&&(v=Tp(p,x)),pi.splice(x,0,v),Xs.splice(x,0,0),$s.splice(x,0,0)}vt("addSeries",x)}function Fb(p,x){x=x??w.length,p=n==1?bd(p,x,Zv,iy):bd(p,x,{},ty),w.splice(x,0,p),Ep(w[x],x)}i.addSeries=Fb;function Bb(p){if(w.splice(p,1),ke){se.values.splice(p,1),Ki.splice(p,1);let x=Ze.splice(p,1)[0];Vs(null,x.firstChild),x.remove()}Ve&&(ue.splice(p,1),pi.splice(p,1)[0].remove(),Xs.splice(p,1),$s.splice(p,1)),vt("delSeries",p)}i.delSeries=Bb;let rs=[!1,!1,!1,!1];function Ub(p,x){if(p._show=p.show,p.show){let v=p.side%2,b=T[p.scale];b==null&&(p.scale=v?w[1].scale:E,b=T[p.scale]);let M=b.time;p.size=ve(p.size),p.space=ve(p.space),p.rotate=ve(p.rotate),Xn(p.incrs)&&p.incrs.forEach(L=>{!$n.has(L)&&$n.set(L,xy(L))}),p.incrs=ve(p.incrs||(b.distr==2?vT:M?_==1?bT:wT:ks)),p.splits=ve(p.splits||(M&&b.distr==1?Pe:b.distr==3?gd:b.distr==4?VT:zT)),p.stroke=ve(p.stroke),p.grid.stroke=ve(p.grid.stroke),p.ticks.stroke=ve(p.ticks.stroke),p.border.stroke=ve(p.border.stroke);let R=p.values;p.values=Xn(R)&&!Xn(R[0])?ve(R):M?Xn(R)?$v(ie,Xv(R,X)):Hv(R)?TT(ie,R):R||ce:R||UT,p.filter=ve(p.filter||(b.distr>=3&&b.log==10?WT:b.distr==3&&b.log==2?qT:my)),p.font=ly(p.font),p.labelFont=ly(p.labelFont),p._size=p.size(i,null,x,0),p._space=p._rotate=p._incrs=p._found=p._splits=p._values=null,p._size>0&&(rs[x]=!0,p._el=Ti(CA,f))}}function to(p,x,v,b){let[M,R,L,B]=v,U=x%2,Y=0;return U==0&&(B||R)&&(Y=x==0&&!M||x==2&&!L?ft(Jv.size/3):0),U==1&&(M||L)&&(Y=x==1&&!R||x==3&&!B?ft(Qv.size/2):0),Y}let Cp=i.padding=(s.padding||[to,to,to,to]).map(p=>ve(Te(p,to))),Cn=i._padding=Cp.map((p,x)=>p(i,x,rs,0)),Mt,pt=null,mt=null,ma=n==1?w[0].idxs:null,ki=null,io=!1;function Rp(p,x){if(e=p??[],i.data=i._data=e,n==2){Mt=0;for(let v=1;v<w.length;v++)Mt+=e[v][0].length}else{e.length==0&&(i.data=i._data=e=[[]]),ki=e[0],Mt=ki.length;let v=e;if(D==2){v=e.slice();let b=v[0]=Array(Mt);for(let M=0;M<Mt;M++)b[M]=M}i._data=e=v}if(Ks(!0),vt("setData"),D==2&&(Gs=!0),x!==!1){let v=k;v.auto(i,io)?sh():Pn(E,v.min,v.max),ns=ns||j.left>=0,di=!0,Js()}}i.setData=Rp;function sh(){io=!0;let p,x;n==1&&(Mt>0?(pt=ma[0]=0,mt=ma[1]=Mt-1,p=e[0][pt],x=e[0][mt],D==2?(p=pt,x=mt):p==x&&(D==3?[p,x]=Mc(p,p,k.log,!1):D==4?[p,x]=Md(p,p,k.log,!1):k.time?x=p+ft(86400/_):[p,x]=_c(p,x,Ad,!0))):(pt=ma[0]=p=null,mt=ma[1]=x=null)),Pn(E,p,x)}let ga,Ys,rh,oh,ah,lh,ch,hh,uh,$t;function Pp(p,x,v,b,M,R){p??=Av,v??=Ed,b??="butt",M??=Av,R??="round",p!=ga&&(u.strokeStyle=ga=p),M!=Ys&&(u.fillStyle=Ys=M),x!=rh&&(u.lineWidth=rh=x),R!=ah&&(u.lineJoin=ah=R),b!=lh&&(u.lineCap=lh=b),v!=oh&&u.setLineDash(oh=v)}function kp(p,x,v,b){x!=Ys&&(u.fillStyle=Ys=x),p!=ch&&(u.font=ch=p),v!=hh&&(u.textAlign=hh=v),b!=uh&&(u.textBaseline=uh=b)}function fh(p,x,v,b,M=0){if(b.length>0&&p.auto(i,io)&&(x==null||x.min==null)){let R=Te(pt,0),L=Te(mt,b.length-1),B=v.min==null?WA(b,R,L,M,p.distr==3):[v.min,v.max];p.min=Xi(p.min,v.min=B[0]),p.max=Gt(p.max,v.max=B[1])}}let Lp={min:null,max:null};function zb(){for(let b in T){let M=T[b];N[b]==null&&(M.min==null||N[E]!=null&&M.auto(i,io))&&(N[b]=Lp)}for(let b in T){let M=T[b];N[b]==null&&M.from!=null&&N[M.from]!=null&&(N[b]=Lp)}N[E]!=null&&Ks(!0);let p={};for(let b in N){let M=N[b];if(M!=null){let R=p[b]=Vr(T[b],QA);if(M.min!=null)lt(R,M);else if(b!=E||n==2)if(Mt==0&&R.from==null){let L=R.range(i,null,null,b);R.min=L[0],R.max=L[1]}else R.min=Oe,R.max=-Oe}}if(Mt>0){w.forEach((b,M)=>{if(n==1){let R=b.scale,L=N[R];if(L==null)return;let B=p[R];if(M==0){let U=B.range(i,B.min,B.max,R);B.min=U[0],B.max=U[1],pt=qi(B.min,e[0]),mt=qi(B.max,e[0]),mt-pt>1&&(e[0][pt]<B.min&&pt++,e[0][mt]>B.max&&mt--),b.min=ki[pt],b.max=ki[mt]}else b.show&&b.auto&&fh(B,L,b,e[M],b.sorted);b.idxs[0]=pt,b.idxs[1]=mt}else if(M>0&&b.show&&b.auto){let[R,L]=b.facets,B=R.scale,U=L.scale,[Y,Z]=e[M],te=p[B],he=p[U];te!=null&&fh(te,N[B],R,Y,R.sorted),he!=null&&fh(he,N[U],L,Z,L.sorted),b.min=L.min,b.max=L.max}});for(let b in p){let M=p[b],R=N[b];if(M.from==null&&(R==null||R.min==null)){let L=M.range(i,M.min==Oe?null:M.min,M.max==-Oe?null:M.max,b);M.min=L[0],M.max=L[1]}}}for(let b in p){let M=p[b];if(M.from!=null){let R=p[M.from];if(R.min==null)M.min=M.max=null;else{let L=M.range(i,R.min,R.max,b);M.min=L[0],M.max=L[1]}}}let x={},v=!1;for(let b in p){let M=p[b],R=T[b];if(R.min!=M.min||R.max!=M.max){R.min=M.min,R.max=M.max;let L=R.distr;R._min=L==3?_n(R.min):L==4?ad(R.min,R.asinh):L==100?R.fwd(R.min):R.min,R._max=L==3?_n(R.max):L==4?ad(R.max,R.asinh):L==100?R.fwd(R.max):R.max,x[b]=v=!0}}if(v){w.forEach((b,M)=>{n==2?M>0&&x.y&&(b._paths=null):x[b.scale]&&(b._paths=null)});for(let b in x)Gs=!0,vt("setScale",b);Ve&&j.left>=0&&(ns=di=!0)}for(let b in N)N[b]=null}function Vb(p){let x=md(pt-1,0,Mt-1),v=md(mt+1,0,Mt-1);for(;p[x]==null&&x>0;)x--;for(;p[v]==null&&v<Mt-1;)v++;return[x,v]}function Hb(){if(Mt>0){let p=w.some(x=>x._focus)&&$t!=Zi.alpha;p&&(u.globalAlpha=$t=Zi.alpha),w.forEach((x,v)=>{if(v>0&&x.show&&(Ip(v,!1),Ip(v,!0),x._paths==null)){let b=$t;$t!=x.alpha&&(u.globalAlpha=$t=x.alpha);let M=n==2?[0,e[v][0].length-1]:Vb(e[v]);x._paths=x.paths(i,v,M[0],M[1]),$t!=b&&(u.globalAlpha=$t=b)}}),w.forEach((x,v)=>{if(v>0&&x.show){let b=$t;$t!=x.alpha&&(u.globalAlpha=$t=x.alpha),x._paths!=null&&Dp(v,!1);{let M=x._paths!=null?x._paths.gaps:null,R=x.points.show(i,v,pt,mt,M),L=x.points.filter(i,v,R,M);(R||L)&&(x.points._paths=x.points.paths(i,v,pt,mt,L),Dp(v,!0))}$t!=b&&(u.globalAlpha=$t=b),vt("drawSeries",v)}}),p&&(u.globalAlpha=$t=1)}}function Ip(p,x){let v=x?w[p].points:w[p];v._stroke=v.stroke(i,p),v._fill=v.fill(i,p)}function Dp(p,x){let v=x?w[p].points:w[p],{stroke:b,fill:M,clip:R,flags:L,_stroke:B=v._stroke,_fill:U=v._fill,_width:Y=v.width}=v._paths;Y=Fe(Y*Re,3);let Z=null,te=Y%2/2;x&&U==null&&(U=Y>0?"#fff":B);let he=v.pxAlign==1&&te>0;if(he&&u.translate(te,te),!x){let Ce=Jt-Y/2,Se=fi-Y/2,ge=Xt+Y,le=Pi+Y;Z=new Path2D,Z.rect(Ce,Se,ge,le)}x?dh(B,Y,v.dash,v.cap,U,b,M,L,R):Gb(p,B,Y,v.dash,v.cap,U,b,M,L,Z,R),he&&u.translate(-te,-te)}function Gb(p,x,v,b,M,R,L,B,U,Y,Z){let te=!1;U!=0&&C.forEach((he,Ce)=>{if(he.series[0]==p){let Se=w[he.series[1]],ge=e[he.series[1]],le=(Se._paths||na).band;Xn(le)&&(le=he.dir==1?le[0]:le[1]);let ne,We=null;Se.show&&le&&XA(ge,pt,mt)?(We=he.fill(i,Ce)||R,ne=Se._paths.clip):le=null,dh(x,v,b,M,We,L,B,U,Y,Z,ne,le),te=!0}}),te||dh(x,v,b,M,R,L,B,U,Y,Z)}let Np=Hr|vd;function dh(p,x,v,b,M,R,L,B,U,Y,Z,te){Pp(p,x,v,b,M),(U||Y||te)&&(u.save(),U&&u.clip(U),Y&&u.clip(Y)),te?(B&Np)==Np?(u.clip(te),Z&&u.clip(Z),va(M,L),xa(p,R,x)):B&vd?(va(M,L),u.clip(te),xa(p,R,x)):B&Hr&&(u.save(),u.clip(te),Z&&u.clip(Z),va(M,L),u.restore(),xa(p,R,x)):(va(M,L),xa(p,R,x)),(U||Y||te)&&u.restore()}function xa(p,x,v){v>0&&(x instanceof Map?x.forEach((b,M)=>{u.strokeStyle=ga=M,u.stroke(b)}):x!=null&&p&&u.stroke(x))}function va(p,x){x instanceof Map?x.forEach((v,b)=>{u.fillStyle=Ys=b,u.fill(v)}):x!=null&&p&&u.fill(x)}function Wb(p,x,v,b){let M=A[p],R;if(b<=0)R=[0,0];else{let L=M._space=M.space(i,p,x,v,b),B=M._incrs=M.incrs(i,p,x,v,b,L);R=dE(x,v,B,b,L)}return M._found=R}function ph(p,x,v,b,M,R,L,B,U,Y){let Z=L%2/2;g==1&&u.translate(Z,Z),Pp(B,L,U,Y,B),u.beginPath();let te,he,Ce,Se,ge=M+(b==0||b==3?-R:R);v==0?(he=M,Se=ge):(te=M,Ce=ge);for(let le=0;le<p.length;le++)x[le]!=null&&(v==0?te=Ce=p[le]:he=Se=p[le],u.moveTo(te,he),u.lineTo(Ce,Se));u.stroke(),g==1&&u.translate(-Z,-Z)}function qb(p){let x=!0;return A.forEach((v,b)=>{if(!v.show)return;let M=T[v.scale];if(M.min==null){v._show&&(x=!1,v._show=!1,Ks(!1));return}else v._show||(x=!1,v._show=!0,Ks(!1));let R=v.side,L=R%2,{min:B,max:U}=M,[Y,Z]=Wb(b,B,U,L==0?fe:Q);if(Z==0)return;let te=M.distr==2,he=v._splits=v.splits(i,b,B,U,Y,Z,te),Ce=M.distr==2?he.map(ne=>ki[ne]):he,Se=M.distr==2?ki[he[1]]-ki[he[0]]:Y,ge=v._values=v.values(i,v.filter(i,Ce,b,Z,Se),b,Z,Se);v._rotate=R==2?v.rotate(i,ge,b,Z):0;let le=v._size;v._size=Ei(v.size(i,ge,b,p)),le!=null&&v._size!=le&&(x=!1)}),x}function Xb(p){let x=!0;return Cp.forEach((v,b)=>{let M=v(i,b,rs,p);M!=Cn[b]&&(x=!1),Cn[b]=M}),x}function $b(){for(let p=0;p<A.length;p++){let x=A[p];if(!x.show||!x._show)continue;let v=x.side,b=v%2,M,R,L=x.stroke(i,p),B=v==0||v==3?-1:1,[U,Y]=x._found;if(x.label!=null){let Ot=x.labelGap*B,Qt=ft((x._lpos+Ot)*Re);kp(x.labelFont[0],L,"center",v==2?"top":Mv),u.save(),b==1?(M=R=0,u.translate(Qt,ft(fi+Pi/2)),u.rotate((v==3?-yc:yc)/2)):(M=ft(Jt+Xt/2),R=Qt);let ls=dy(x.label)?x.label(i,p,U,Y):x.label;u.fillText(ls,M,R),u.restore()}if(Y==0)continue;let Z=T[x.scale],te=b==0?Xt:Pi,he=b==0?Jt:fi,Ce=x._splits,Se=Z.distr==2?Ce.map(Ot=>ki[Ot]):Ce,ge=Z.distr==2?ki[Ce[1]]-ki[Ce[0]]:U,le=x.ticks,ne=x.border,We=le.show?le.size:0,Qe=ft(We*Re),yt=ft((x.alignTo==2?x._size-We-x.gap:x.gap)*Re),De=x._rotate*-yc/180,et=y(x._pos*Re),Zt=(Qe+yt)*B,Nt=et+Zt;R=b==0?Nt:0,M=b==1?Nt:0;let mi=x.font[0],Li=x.align==1?Or:x.align==2?sd:De>0?Or:De<0?sd:b==0?"center":v==3?sd:Or,en=De||b==1?"middle":v==2?"top":Mv;kp(mi,L,Li,en);let jt=x.font[1]*x.lineGap,gi=Ce.map(Ot=>y(a(Ot,Z,te,he))),Ii=x._values;for(let Ot=0;Ot<Ii.length;Ot++){let Qt=Ii[Ot];if(Qt!=null){b==0?M=gi[Ot]:R=gi[Ot],Qt=""+Qt;let ls=Qt.indexOf(`
`)==-1?[Qt]:Qt.split(/\n/gm);for(let Ft=0;Ft<ls.length;Ft++){let em=ls[Ft];De?(u.save(),u.translate(M,R+Ft*jt),u.rotate(De),u.fillText(em,0,0),u.restore()):u.fillText(em,M,R+Ft*jt)}}}le.show&&ph(gi,le.filter(i,Se,p,Y,ge),b,v,et,Qe,Fe(le.width*Re,3),le.stroke(i,p),le.dash,le.cap);let tn=x.grid;tn.show&&ph(gi,tn.filter(i,Se,p,Y,ge),b,b==0?2:1,b==0?fi:Jt,b==0?Pi:Xt,Fe(tn.width*Re,3),tn.stroke(i,p),tn.dash,tn.cap),ne.show&&ph([et],[1],b==0?1:0,b==0?1:2,b==1?fi:Jt,b==1?Pi:Xt,Fe(ne.width*Re,3),ne.stroke(i,p),ne.dash,ne.cap)}vt("drawAxes")}function Ks(p){w.forEach((x,v)=>{v>0&&(x._paths=null,p&&(n==1?(x.min=null,x.max=null):x.facets.forEach(b=>{b.min=null,b.max=null})))})}let ya=!1,mh=!1,no=[];function Yb(){mh=!1;for(let p=0;p<no.length;p++)vt(...no[p]);no.length=0}function Js(){ya||(oT(Op),ya=!0)}function Kb(p,x=!1){ya=!0,mh=x,p(i),Op(),x&&no.length>0&&queueMicrotask(Yb)}i.batch=Kb;function Op(){if(ih&&(zb(),ih=!1),Gs&&(Ib(),Gs=!1),da){if(qe(d,Or,Be),qe(d,"top",ct),qe(d,Qo,fe),qe(d,ea,Q),qe(m,Or,Be),qe(m,"top",ct),qe(m,Qo,fe),qe(m,ea,Q),qe(f,Qo,dn),qe(f,ea,es),h.width=ft(dn*Re),h.height=ft(es*Re),A.forEach(({_el:p,_show:x,_size:v,_pos:b,side:M})=>{if(p!=null)if(x){let R=M===3||M===0?v:0,L=M%2==1;qe(p,L?"left":"top",b-R),qe(p,L?"width":"height",v),qe(p,L?"top":"left",L?ct:Be),qe(p,L?"height":"width",L?Q:fe),dd(p,Ls)}else oi(p,Ls)}),ga=Ys=rh=ah=lh=ch=hh=uh=oh=null,$t=1,oo(!0),Be!=Hs||ct!=ts||fe!=Ji||Q!=is){Ks(!1);let p=fe/Ji,x=Q/is;if(Ve&&!ns&&j.left>=0){j.left*=p,j.top*=x,Zs&&un(Zs,ft(j.left),0,fe,Q),js&&un(js,0,ft(j.top),fe,Q);for(let v=0;v<pi.length;v++){let b=pi[v];b!=null&&(Xs[v]*=p,$s[v]*=x,un(b,Ei(Xs[v]),Ei($s[v]),fe,Q))}}if(Ge.show&&!pa&&Ge.left>=0&&Ge.width>0){Ge.left*=p,Ge.width*=p,Ge.top*=x,Ge.height*=x;for(let v in _h)qe(tr,v,Ge[v])}Hs=Be,ts=ct,Ji=fe,is=Q}vt("setSize"),da=!1}dn>0&&es>0&&(u.clearRect(0,0,h.width,h.height),vt("drawClear"),O.forEach(p=>p()),vt("draw")),Ge.show&&pa&&(ba(Ge),pa=!1),Ve&&ns&&(as(null,!0,!1),ns=!1),se.show&&se.live&&di&&(yh(),di=!1),l||(l=!0,i.status=1,vt("ready")),io=!1,ya=!1}i.redraw=(p,x)=>{Gs=x||!1,p!==!1?Pn(E,k.min,k.max):Js()};function gh(p,x){let v=T[p];if(v.from==null){if(Mt==0){let b=v.range(i,x.min,x.max,p);x.min=b[0],x.max=b[1]}if(x.min>x.max){let b=x.min;x.min=x.max,x.max=b}if(Mt>1&&x.min!=null&&x.max!=null&&x.max-x.min<1e-16)return;p==E&&v.distr==2&&Mt>0&&(x.min=qi(x.min,e[0]),x.max=qi(x.max,e[0]),x.min==x.max&&x.max++),N[p]=x,ih=!0,Js()}}i.setScale=gh;let xh,vh,Zs,js,Fp,Bp,Qs,er,Up,zp,He,$e,Rn=!1,At=j.drag,gt=At.x,xt=At.y;Ve&&(j.x&&(xh=Ti(PA,m)),j.y&&(vh=Ti(kA,m)),k.ori==0?(Zs=xh,js=vh):(Zs=vh,js=xh),He=j.left,$e=j.top);let Ge=i.select=lt({show:!0,over:!0,left:0,width:0,top:0,height:0},s.select),tr=Ge.show?Ti(RA,Ge.over?m:d):null;function ba(p,x){if(Ge.show){for(let v in p)Ge[v]=p[v],v in _h&&qe(tr,v,p[v]);x!==!1&&vt("setSelect")}}i.setSelect=ba;function Jb(p){if(w[p].show)ke&&dd(Ze[p],Ls);else if(ke&&oi(Ze[p],Ls),Ve){let v=qs?pi[0]:pi[p];v!=null&&un(v,-10,-10,fe,Q)}}function Pn(p,x,v){gh(p,{min:x,max:v})}function ji(p,x,v,b){x.focus!=null&&t_(p),x.show!=null&&w.forEach((M,R)=>{R>0&&(p==R||p==null)&&(M.show=x.show,Jb(R),n==2?(Pn(M.facets[0].scale,null,null),Pn(M.facets[1].scale,null,null)):Pn(M.scale,null,null),Js())}),v!==!1&&vt("setSeries",p,x),b&&ao("setSeries",i,p,x)}i.setSeries=ji;function Zb(p,x){lt(C[p],x)}function jb(p,x){p.fill=ve(p.fill||null),p.dir=Te(p.dir,-1),x=x??C.length,C.splice(x,0,p)}function Qb(p){p==null?C.length=0:C.splice(p,1)}i.addBand=jb,i.setBand=Zb,i.delBand=Qb;function e_(p,x){w[p].alpha=x,Ve&&pi[p]!=null&&(pi[p].style.opacity=x),ke&&Ze[p]&&(Ze[p].style.opacity=x)}let pn,kn,os,ir={focus:!0};function t_(p){if(p!=os){let x=p==null,v=Zi.alpha!=1;w.forEach((b,M)=>{if(n==1||M>0){let R=x||M==0||M==p;b._focus=x?null:R,v&&e_(M,R?1:Zi.alpha)}}),os=p,v&&Js()}}ke&&Ws&&Dt(Cv,xe,p=>{j._lock||(ss(p),os!=null&&ji(null,ir,!0,st.setSeries))});function Qi(p,x,v){let b=T[x];v&&(p=p/Re-(b.ori==1?ct:Be));let M=fe;b.ori==1&&(M=Q,p=M-p),b.dir==-1&&(p=M-p);let R=b._min,L=b._max,B=p/M,U=R+(L-R)*B,Y=b.distr;return Y==3?Ur(10,U):Y==4?YA(U,b.asinh):Y==100?b.bwd(U):U}function i_(p,x){let v=Qi(p,E,x);return qi(v,e[0],pt,mt)}i.valToIdx=p=>qi(p,e[0]),i.posToIdx=i_,i.posToVal=Qi,i.valToPos=(p,x,v)=>T[x].ori==0?r(p,T[x],v?Xt:fe,v?Jt:0):o(p,T[x],v?Pi:Q,v?fi:0),i.setCursor=(p,x,v)=>{He=p.left,$e=p.top,as(null,x,v)};function Vp(p,x){qe(tr,Or,Ge.left=p),qe(tr,Qo,Ge.width=x)}function Hp(p,x){qe(tr,"top",Ge.top=p),qe(tr,ea,Ge.height=x)}let so=k.ori==0?Vp:Hp,ro=k.ori==1?Vp:Hp;function n_(){if(ke&&se.live)for(let p=n==2?1:0;p<w.length;p++){if(p==0&&ui)continue;let x=se.values[p],v=0;for(let b in x)Ki[p][v++].firstChild.nodeValue=x[b]}}function yh(p,x){if(p!=null&&(p.idxs?p.idxs.forEach((v,b)=>{ue[b]=v}):jA(p.idx)||ue.fill(p.idx),se.idx=ue[0]),ke&&se.live){for(let v=0;v<w.length;v++)(v>0||n==1&&!ui)&&s_(v,ue[v]);n_()}di=!1,x!==!1&&vt("setLegend")}i.setLegend=yh;function s_(p,x){let v=w[p],b=p==0&&D==2?ki:e[p],M;ui?M=v.values(i,p,x)??En:(M=v.value(i,x==null?null:b[x],p,x),M=M==null?En:{_:M}),se.values[p]=M}function as(p,x,v){Up=He,zp=$e,[He,$e]=j.move(i,He,$e),j.left=He,j.top=$e,Ve&&(Zs&&un(Zs,ft(He),0,fe,Q),js&&un(js,0,ft($e),fe,Q));let b,M=pt>mt;pn=Oe,kn=null;let R=k.ori==0?fe:Q,L=k.ori==1?fe:Q;if(He<0||Mt==0||M){b=j.idx=null;for(let B=0;B<w.length;B++){let U=pi[B];U!=null&&un(U,-10,-10,fe,Q)}Ws&&ji(null,ir,!0,p==null&&st.setSeries),se.live&&(ue.fill(b),di=!0)}else{let B,U,Y;n==1&&(B=k.ori==0?He:$e,U=Qi(B,E),b=j.idx=qi(U,e[0],pt,mt),Y=F(e[0][b],k,R,0));let Z=-10,te=-10,he=0,Ce=0,Se=!0,ge="",le="";for(let ne=n==2?1:0;ne<w.length;ne++){let We=w[ne],Qe=ue[ne],yt=Qe==null?null:n==1?e[ne][Qe]:e[ne][1][Qe],De=j.dataIdx(i,ne,b,U),et=De==null?null:n==1?e[ne][De]:e[ne][1][De];if(di=di||et!=yt||De!=Qe,ue[ne]=De,ne>0&&We.show){let Zt=De==null?-10:De==b?Y:F(n==1?e[0][De]:e[ne][0][De],k,R,0),Nt=et==null?-10:V(et,n==1?T[We.scale]:T[We.facets[1].scale],L,0);if(Ws&&et!=null){let mi=k.ori==1?He:$e,Li=dt(Zi.dist(i,ne,De,Nt,mi));if(Li<pn){let en=Zi.bias;if(en!=0){let jt=Qi(mi,We.scale),gi=et>=0?1:-1,Ii=jt>=0?1:-1;Ii==gi&&(Ii==1?en==1?et>=jt:et<=jt:en==1?et<=jt:et>=jt)&&(pn=Li,kn=ne)}else pn=Li,kn=ne}}if(di||qs){let mi,Li;k.ori==0?(mi=Zt,Li=Nt):(mi=Nt,Li=Zt);let en,jt,gi,Ii,tn,Ot,Qt=!0,ls=Ct.bbox;if(ls!=null){Qt=!1;let Ft=ls(i,ne);gi=Ft.left,Ii=Ft.top,en=Ft.width,jt=Ft.height}else gi=mi,Ii=Li,en=jt=Ct.size(i,ne);if(Ot=Ct.fill(i,ne),tn=Ct.stroke(i,ne),qs)ne==kn&&pn<=Zi.prox&&(Z=gi,te=Ii,he=en,Ce=jt,Se=Qt,ge=Ot,le=tn);else{let Ft=pi[ne];Ft!=null&&(Xs[ne]=gi,$s[ne]=Ii,Nv(Ft,en,jt,Qt),Iv(Ft,Ot,tn),un(Ft,Ei(gi),Ei(Ii),fe,Q))}}}}if(qs){let ne=Zi.prox,We=os==null?pn<=ne:pn>ne||kn!=os;if(di||We){let Qe=pi[0];Qe!=null&&(Xs[0]=Z,$s[0]=te,Nv(Qe,he,Ce,Se),Iv(Qe,ge,le),un(Qe,Ei(Z),Ei(te),fe,Q))}}}if(Ge.show&&Rn)if(p!=null){let[B,U]=st.scales,[Y,Z]=st.match,[te,he]=p.cursor.sync.scales,Ce=p.cursor.drag;if(gt=Ce._x,xt=Ce._y,gt||xt){let{left:Se,top:ge,width:le,height:ne}=p.select,We=p.scales[te].ori,Qe=p.posToVal,yt,De,et,Zt,Nt,mi=B!=null&&Y(B,te),Li=U!=null&&Z(U,he);mi&&gt?(We==0?(yt=Se,De=le):(yt=ge,De=ne),et=T[B],Zt=F(Qe(yt,te),et,R,0),Nt=F(Qe(yt+De,te),et,R,0),so(Xi(Zt,Nt),dt(Nt-Zt))):so(0,R),Li&&xt?(We==1?(yt=Se,De=le):(yt=ge,De=ne),et=T[U],Zt=V(Qe(yt,he),et,L,0),Nt=V(Qe(yt+De,he),et,L,0),ro(Xi(Zt,Nt),dt(Nt-Zt))):ro(0,L)}else Sh()}else{let B=dt(Up-Fp),U=dt(zp-Bp);if(k.ori==1){let he=B;B=U,U=he}gt=At.x&&B>=At.dist,xt=At.y&&U>=At.dist;let Y=At.uni;Y!=null?gt&&xt&&(gt=B>=Y,xt=U>=Y,!gt&&!xt&&(U>B?xt=!0:gt=!0)):At.x&&At.y&&(gt||xt)&&(gt=xt=!0);let Z,te;gt&&(k.ori==0?(Z=Qs,te=He):(Z=er,te=$e),so(Xi(Z,te),dt(te-Z)),xt||ro(0,L)),xt&&(k.ori==1?(Z=Qs,te=He):(Z=er,te=$e),ro(Xi(Z,te),dt(te-Z)),gt||so(0,R)),!gt&&!xt&&(so(0,0),ro(0,0))}if(At._x=gt,At._y=xt,p==null){if(v){if(Qp!=null){let[B,U]=st.scales;st.values[0]=B!=null?Qi(k.ori==0?He:$e,B):null,st.values[1]=U!=null?Qi(k.ori==1?He:$e,U):null}ao(rd,i,He,$e,fe,Q,b)}if(Ws){let B=v&&st.setSeries,U=Zi.prox;os==null?pn<=U&&ji(kn,ir,!0,B):pn>U?ji(null,ir,!0,B):kn!=os&&ji(kn,ir,!0,B)}}di&&(se.idx=b,yh()),x!==!1&&vt("setCursor")}let Ln=null;Object.defineProperty(i,"rect",{get(){return Ln==null&&oo(!1),Ln}});function oo(p=!1){p?Ln=null:(Ln=m.getBoundingClientRect(),vt("syncRect",Ln))}function Gp(p,x,v,b,M,R,L){j._lock||Rn&&p!=null&&p.movementX==0&&p.movementY==0||(bh(p,x,v,b,M,R,L,!1,p!=null),p!=null?as(null,!0,!0):as(x,!0,!1))}function bh(p,x,v,b,M,R,L,B,U){if(Ln==null&&oo(!1),ss(p),p!=null)v=p.clientX-Ln.left,b=p.clientY-Ln.top;else{if(v<0||b<0){He=-10,$e=-10;return}let[Y,Z]=st.scales,te=x.cursor.sync,[he,Ce]=te.values,[Se,ge]=te.scales,[le,ne]=st.match,We=x.axes[0].side%2==1,Qe=k.ori==0?fe:Q,yt=k.ori==1?fe:Q,De=We?R:M,et=We?M:R,Zt=We?b:v,Nt=We?v:b;if(Se!=null?v=le(Y,Se)?a(he,T[Y],Qe,0):-10:v=Qe*(Zt/De),ge!=null?b=ne(Z,ge)?a(Ce,T[Z],yt,0):-10:b=yt*(Nt/et),k.ori==1){let mi=v;v=b,b=mi}}U&&(x==null||x.cursor.event.type==rd)&&((v<=1||v>=fe-1)&&(v=Ps(v,fe)),(b<=1||b>=Q-1)&&(b=Ps(b,Q))),B?(Fp=v,Bp=b,[Qs,er]=j.move(i,v,b)):(He=v,$e=b)}let _h={width:0,height:0,left:0,top:0};function Sh(){ba(_h,!1)}let Wp,qp,Xp,$p;function Yp(p,x,v,b,M,R,L){Rn=!0,gt=xt=At._x=At._y=!1,bh(p,x,v,b,M,R,L,!0,!1),p!=null&&(Dt(od,ud,Kp,!1),ao(Tv,i,Qs,er,fe,Q,null));let{left:B,top:U,width:Y,height:Z}=Ge;Wp=B,qp=U,Xp=Y,$p=Z}function Kp(p,x,v,b,M,R,L){Rn=At._x=At._y=!1,bh(p,x,v,b,M,R,L,!1,!0);let{left:B,top:U,width:Y,height:Z}=Ge,te=Y>0||Z>0,he=Wp!=B||qp!=U||Xp!=Y||$p!=Z;if(te&&he&&ba(Ge),At.setScale&&te&&he){let Ce=B,Se=Y,ge=U,le=Z;if(k.ori==1&&(Ce=U,Se=Z,ge=B,le=Y),gt&&Pn(E,Qi(Ce,E),Qi(Ce+Se,E)),xt)for(let ne in T){let We=T[ne];ne!=E&&We.from==null&&We.min!=Oe&&Pn(ne,Qi(ge+le,ne),Qi(ge,ne))}Sh()}else j.lock&&(j._lock=!j._lock,as(x,!0,p!=null));p!=null&&(Vs(od,ud),ao(od,i,He,$e,fe,Q,null))}function r_(p,x,v,b,M,R,L){if(j._lock)return;ss(p);let B=Rn;if(Rn){let U=!0,Y=!0,Z=10,te,he;k.ori==0?(te=gt,he=xt):(te=xt,he=gt),te&&he&&(U=He<=Z||He>=fe-Z,Y=$e<=Z||$e>=Q-Z),te&&U&&(He=He<Qs?0:fe),he&&Y&&($e=$e<er?0:Q),as(null,!0,!0),Rn=!1}He=-10,$e=-10,ue.fill(null),as(null,!0,!0),B&&(Rn=B)}function Jp(p,x,v,b,M,R,L){j._lock||(ss(p),sh(),Sh(),p!=null&&ao(Rv,i,He,$e,fe,Q,null))}function Zp(){A.forEach(pE),nh(i.width,i.height,!0)}Is(bc,Br,Zp);let nr={};nr.mousedown=Yp,nr.mousemove=Gp,nr.mouseup=Kp,nr.dblclick=Jp,nr.setSeries=(p,x,v,b)=>{let M=st.match[2];v=M(i,x,v),v!=-1&&ji(v,b,!0,!1)},Ve&&(Dt(Tv,m,Yp),Dt(rd,m,Gp),Dt(Ev,m,p=>{ss(p),oo(!1)}),Dt(Cv,m,r_),Dt(Rv,m,Jp),yd.add(i),i.syncRect=oo);let _a=i.hooks=s.hooks||{};function vt(p,x,v){mh?no.push([p,x,v]):p in _a&&_a[p].forEach(b=>{b.call(null,i,x,v)})}(s.plugins||[]).forEach(p=>{for(let x in p.hooks)_a[x]=(_a[x]||[]).concat(p.hooks[x])});let jp=(p,x,v)=>v,st=lt({key:null,setSeries:!1,filters:{pub:zv,sub:zv},scales:[E,w[1]?w[1].scale:null],match:[Vv,Vv,jp],values:[null,null]},j.sync);st.match.length==2&&st.match.push(jp),j.sync=st;let Qp=st.key,wh=Fy(Qp);function ao(p,x,v,b,M,R,L){st.filters.pub(p,x,v,b,M,R,L)&&wh.pub(p,x,v,b,M,R,L)}wh.sub(i);function o_(p,x,v,b,M,R,L){st.filters.sub(p,x,v,b,M,R,L)&&nr[p](null,x,v,b,M,R,L)}i.pub=o_;function a_(){wh.unsub(i),yd.delete(i),Qn.clear(),pd(bc,Br,Zp),c.remove(),xe?.remove(),vt("destroy")}i.destroy=a_;function Mh(){vt("init",s,e),Rp(e||s.data,!1),N[E]?gh(E,N[E]):sh(),pa=Ge.show&&(Ge.width>0||Ge.height>0),ns=di=!0,nh(s.width,s.height)}return w.forEach(Ep),A.forEach(Ub),t?t instanceof HTMLElement?(t.appendChild(c),Mh()):t(i,Mh):Mh(),i}Et.assign=lt;Et.fmtNum=Td;Et.rangeNum=_c;Et.rangeLog=Mc;Et.rangeAsinh=Md;Et.orient=Ns;Et.pxRatio=Re;Et.join=rT;Et.fmtDate=Cd,Et.tzDate=gT;Et.sync=Fy;{Et.addGap=jT,Et.clipGaps=Ec;let s=Et.paths={points:Gy};s.linear=qy,s.stepped=tE,s.bars=iE,s.spline=sE}var mE=24,kc=class{constructor(e){this.studio=e;let t=S("div",{className:"bar"},S("h2",{},"Response"),S("label",{},"from ",this.input),S("label",{},"to ",this.output),this.told);K(re("response"),t,this.root),e.figures.watch(this.redraw),e.mode.watch(this.redraw),e.against.watch(this.redraw),e.state.watch(()=>this.offer()),new ResizeObserver(this.redraw).observe(this.root),matchMedia("(prefers-color-scheme: dark)").addEventListener("change",this.redraw)}studio;root=S("div",{id:"curves"});input=S("select",{ariaLabel:"input",change:()=>this.choose()});output=S("select",{ariaLabel:"output",change:()=>this.choose()});told=S("span",{className:"quiet cursor"});redraw=Sa(()=>this.draw());plots=[];channels="";offer(){let e=this.studio.state.value,t=JSON.stringify([e?.inputs,e?.outputs]);if(!(!e||t===this.channels)){this.channels=t;for(let[i,n]of[[this.input,e.inputs],[this.output,e.outputs]])i.replaceChildren(new Option("as chosen",""),...n.map(r=>new Option(r)))}}choose(){let e=this.input.value?[this.input.value]:[],t=this.output.value?[this.output.value]:[];this.studio.connection.newest("respond",{kind:"respond",inputs:e,outputs:t,low:null,high:null})}draw(){for(let o of this.plots)o.destroy();this.plots=[];let e=this.studio.figures.value;if(!e?.frequency||!e.curves.length||this.root.clientWidth<40){K(this.root,S("p",{className:"quiet"},e?.missing.curves??e?.missing.response??"No response yet."));return}let t=this.studio.kept.get(this.studio.against.value)?.figures??null,i=t===e?null:t;K(this.root);let n=Math.max(this.root.clientHeight,150),r=Math.round(.34*n);this.name(e,i),this.plots=[this.plot(e,i,"magnitude",n-r),this.plot(e,i,"phase",r)]}plot(e,t,i,n){let r=e.curves.slice(0,4),o=r.map(u=>t?.curves.find(f=>f.input===u.input&&f.output===u.output)??null),[a,...l]=gE(e,t,r,o,i),c=[{},...r.map((u,f)=>Ky(u,f,!1)),...o.filter(u=>u!==null).map((u,f)=>Ky(u,f,!0))],h={width:this.root.clientWidth,height:n,legend:{show:!1},cursor:{sync:{key:"response"},points:{size:6},drag:{x:!1,y:!1}},scales:{x:{time:!1,distr:3},y:yE(i)},axes:[Jy(i==="phase"?26:8,i==="phase"?Zy:()=>[]),{...Jy(54,Zy),...i==="phase"?{incrs:[90,180,360]}:{}}],series:c,hooks:{draw:[u=>this.modes(u,i)],setCursor:[u=>this.tell(u,r)],ready:[u=>this.listen(u)]}};return new Et(h,[a,...l],this.root)}listen(e){e.over.addEventListener("click",()=>this.play(e)),e.over.addEventListener("mouseleave",this.redraw)}listed(){let e=this.studio.figures.value?.modes??[],t=e.filter(i=>i.platform);return t.length?t:e}play(e){let t=e.cursor.left??-1,i=this.listed().map(r=>({each:r,away:Math.abs(e.valToPos(r.frequency,"x")-t)})),[n]=i.sort((r,o)=>r.away-o.away);n&&n.away<mE&&this.studio.mode.set(n.each.number)}modes(e,t){let{ctx:i,bbox:n}=e,r=getComputedStyle(this.root);i.save();let o=-1e9;for(let a of this.listed()){let l=e.valToPos(a.frequency,"x",!0);if(l<n.left||l>n.left+n.width)continue;let c=a.number===this.studio.mode.value;i.strokeStyle=r.getPropertyValue(c?"--accent":"--edge"),i.lineWidth=(c?2:1)*devicePixelRatio,i.beginPath(),i.moveTo(l,n.top),i.lineTo(l,n.top+n.height),i.stroke(),!(t!=="magnitude"||l<o)&&(i.fillStyle=r.getPropertyValue(c?"--accent":"--quiet"),i.font=`${10*devicePixelRatio}px sans-serif`,i.fillText(String(a.number),l+2*devicePixelRatio,n.top+10*devicePixelRatio),o=l+14*devicePixelRatio)}i.restore()}name(e,t){let i=e.curves.slice(0,4).flatMap((n,r)=>[S("i",{className:`curve-${r}`}),`${n.output}/${n.input}`]);K(this.told,...i,...t?[S("i",{className:"dashed"}),this.studio.against.value||"file"]:[])}tell(e,t){let i=e.cursor.idx,n=i==null?void 0:e.data[0][i],[r,o]=this.plots;if(i==null||n===void 0||!r||!o)return;let a=t.map((l,c)=>`${l.output}/${l.input} ${we(r.data[c+1]?.[i],4)} ${l.unit}, ${we(o.data[c+1]?.[i],4)}°`);K(this.told,`${we(n)} Hz: ${a.join(";  ")}`),this.told.title=this.told.textContent??""}};function gE(s,e,t,i,n){let r=s.frequency?Zo(s.frequency):[],o=e?.frequency?Zo(e.frequency):[],a=i.filter(l=>l!==null).map(l=>xE(r,o,Zo(l[n])));return[r,...t.map(l=>Zo(l[n])),...a]}function xE(s,e,t){let i=0;return s.map(n=>{for(;i<e.length-2&&(e[i+1]??0)<n;)i+=1;let[r,o]=[e[i]??NaN,e[i+1]??NaN],a=(n-r)/(o-r);return a>=-1e-9&&a<=1+1e-9?(1-a)*(t[i]??NaN)+a*(t[i+1]??NaN):null})}var vE=s=>()=>getComputedStyle(document.documentElement).getPropertyValue(`--curve-${s%4}`);function Ky(s,e,t){return{label:`${s.output}/${s.input}`,stroke:vE(e),width:t?1:1.6,points:{show:!1},...t?{dash:[5,4]}:{}}}function yE(s){return s==="magnitude"?{distr:3}:{auto:!0}}function Jy(s,e){return{stroke:()=>getComputedStyle(document.documentElement).getPropertyValue("--quiet"),size:s,font:"10px sans-serif",grid:{stroke:()=>getComputedStyle(document.documentElement).getPropertyValue("--faint"),width:1},ticks:{show:!1},...e?{values:e}:{}}}function Zy(s,e){return e.map(t=>t===null?"":we(t,3))}var fb=1;var db=3;var Hd=0,Gd=1,Wd=2,qd=3,Xd=4,$d=5,Yd=6,Kd=7,pb=0,mb=1,gb=2;var cp=1,hp=2,up=3,fp=4,dp=5,pp=6,mp=7;var gp=300;var xb=302;var Jd=1e3,oa=1001,Zd=1002;var vb=1006;var yb=1008;var bb=1009;var _b=1023;var la=2300,Uc=2301,Oc=2302,jd=2303,Qd=2400,ep=2401,tp=2402;var xp="",Ri="srgb",ip="srgb-linear",np="linear",Fc="srgb";var aa=2e3,sp=2001;function bE(s){return ArrayBuffer.isView(s)&&!(s instanceof DataView)}function rp(s){return document.createElementNS("http://www.w3.org/1999/xhtml",s)}var jy={},zc=null;function Sb(s){let e=s[0];if(typeof e=="string"&&e.startsWith("TSL:")){let t=s[1];t&&t.isStackTrace?s[0]+=" "+t.getLocation():s[1]='Stack trace not available. Enable "THREE.Node.captureStackTrace" to capture stack traces.'}return s}function It(...s){s=Sb(s);let e="THREE."+s.shift();if(zc)zc("warn",e,...s);else{let t=s[0];t&&t.isStackTrace?console.warn(t.getError(e)):console.warn(e,...s)}}function St(...s){s=Sb(s);let e="THREE."+s.shift();if(zc)zc("error",e,...s);else{let t=s[0];t&&t.isStackTrace?console.error(t.getError(e)):console.error(e,...s)}}function Bc(...s){let e=s.join(" ");e in jy||(jy[e]=!0,It(...s))}var _E={[Hd]:Hd,[Wd]:Yd,[Xd]:Xd,[qd]:$d,[Gd]:Gd,[Yd]:Wd,[Kd]:Kd,[$d]:qd},ca=class{addEventListener(e,t){this._listeners===void 0&&(this._listeners={});let i=this._listeners;i[e]===void 0&&(i[e]=[]),i[e].indexOf(t)===-1&&i[e].push(t)}hasEventListener(e,t){let i=this._listeners;return i===void 0?!1:i[e]!==void 0&&i[e].indexOf(t)!==-1}removeEventListener(e,t){let i=this._listeners;if(i===void 0)return;let n=i[e];if(n!==void 0){let r=n.indexOf(t);r!==-1&&n.splice(r,1)}}dispatchEvent(e){let t=this._listeners;if(t===void 0)return;let i=t[e.type];if(i!==void 0){e.target=this;let n=i.slice(0);for(let r=0,o=n.length;r<o;r++)n[r].call(this,e);e.target=null}}},kt=["00","01","02","03","04","05","06","07","08","09","0a","0b","0c","0d","0e","0f","10","11","12","13","14","15","16","17","18","19","1a","1b","1c","1d","1e","1f","20","21","22","23","24","25","26","27","28","29","2a","2b","2c","2d","2e","2f","30","31","32","33","34","35","36","37","38","39","3a","3b","3c","3d","3e","3f","40","41","42","43","44","45","46","47","48","49","4a","4b","4c","4d","4e","4f","50","51","52","53","54","55","56","57","58","59","5a","5b","5c","5d","5e","5f","60","61","62","63","64","65","66","67","68","69","6a","6b","6c","6d","6e","6f","70","71","72","73","74","75","76","77","78","79","7a","7b","7c","7d","7e","7f","80","81","82","83","84","85","86","87","88","89","8a","8b","8c","8d","8e","8f","90","91","92","93","94","95","96","97","98","99","9a","9b","9c","9d","9e","9f","a0","a1","a2","a3","a4","a5","a6","a7","a8","a9","aa","ab","ac","ad","ae","af","b0","b1","b2","b3","b4","b5","b6","b7","b8","b9","ba","bb","bc","bd","be","bf","c0","c1","c2","c3","c4","c5","c6","c7","c8","c9","ca","cb","cc","cd","ce","cf","d0","d1","d2","d3","d4","d5","d6","d7","d8","d9","da","db","dc","dd","de","df","e0","e1","e2","e3","e4","e5","e6","e7","e8","e9","ea","eb","ec","ed","ee","ef","f0","f1","f2","f3","f4","f5","f6","f7","f8","f9","fa","fb","fc","fd","fe","ff"];var Ok=Math.PI/180,SE=180/Math.PI;function vp(){let s=Math.random()*4294967295|0,e=Math.random()*4294967295|0,t=Math.random()*4294967295|0,i=Math.random()*4294967295|0;return(kt[s&255]+kt[s>>8&255]+kt[s>>16&255]+kt[s>>24&255]+"-"+kt[e&255]+kt[e>>8&255]+"-"+kt[e>>16&15|64]+kt[e>>24&255]+"-"+kt[t&63|128]+kt[t>>8&255]+"-"+kt[t>>16&255]+kt[t>>24&255]+kt[i&255]+kt[i>>8&255]+kt[i>>16&255]+kt[i>>24&255]).toLowerCase()}function _e(s,e,t){return Math.max(e,Math.min(t,s))}function wE(s,e){return(s%e+e)%e}function Nd(s,e,t){return(1-t)*s+t*e}var Yi=class{static{this.prototype.isVector2=!0}constructor(e=0,t=0){this.x=e,this.y=t}get width(){return this.x}set width(e){this.x=e}get height(){return this.y}set height(e){this.y=e}set(e,t){return this.x=e,this.y=t,this}setScalar(e){return this.x=e,this.y=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;default:throw new Error("THREE.Vector2: index is out of range: "+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;default:throw new Error("THREE.Vector2: index is out of range: "+e)}}clone(){return new this.constructor(this.x,this.y)}copy(e){return this.x=e.x,this.y=e.y,this}add(e){return this.x+=e.x,this.y+=e.y,this}addScalar(e){return this.x+=e,this.y+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this}subScalar(e){return this.x-=e,this.y-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this}multiply(e){return this.x*=e.x,this.y*=e.y,this}multiplyScalar(e){return this.x*=e,this.y*=e,this}divide(e){return this.x/=e.x,this.y/=e.y,this}divideScalar(e){return this.multiplyScalar(1/e)}applyMatrix3(e){let t=this.x,i=this.y,n=e.elements;return this.x=n[0]*t+n[3]*i+n[6],this.y=n[1]*t+n[4]*i+n[7],this}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this}clamp(e,t){return this.x=_e(this.x,e.x,t.x),this.y=_e(this.y,e.y,t.y),this}clampScalar(e,t){return this.x=_e(this.x,e,t),this.y=_e(this.y,e,t),this}clampLength(e,t){let i=this.length();return this.divideScalar(i||1).multiplyScalar(_e(i,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this}negate(){return this.x=-this.x,this.y=-this.y,this}dot(e){return this.x*e.x+this.y*e.y}cross(e){return this.x*e.y-this.y*e.x}lengthSq(){return this.x*this.x+this.y*this.y}length(){return Math.sqrt(this.x*this.x+this.y*this.y)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)}normalize(){return this.divideScalar(this.length()||1)}angle(){return Math.atan2(-this.y,-this.x)+Math.PI}angleTo(e){let t=Math.sqrt(this.lengthSq()*e.lengthSq());if(t===0)return Math.PI/2;let i=this.dot(e)/t;return Math.acos(_e(i,-1,1))}distanceTo(e){return Math.sqrt(this.distanceToSquared(e))}distanceToSquared(e){let t=this.x-e.x,i=this.y-e.y;return t*t+i*i}manhattanDistanceTo(e){return Math.abs(this.x-e.x)+Math.abs(this.y-e.y)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this}lerpVectors(e,t,i){return this.x=e.x+(t.x-e.x)*i,this.y=e.y+(t.y-e.y)*i,this}equals(e){return e.x===this.x&&e.y===this.y}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this}rotateAround(e,t){let i=Math.cos(t),n=Math.sin(t),r=this.x-e.x,o=this.y-e.y;return this.x=r*i-o*n+e.x,this.y=r*n+o*i+e.y,this}random(){return this.x=Math.random(),this.y=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y}},Tn=class{constructor(e=0,t=0,i=0,n=1){this.isQuaternion=!0,this._x=e,this._y=t,this._z=i,this._w=n}static slerpFlat(e,t,i,n,r,o,a){let l=i[n+0],c=i[n+1],h=i[n+2],u=i[n+3],f=r[o+0],d=r[o+1],m=r[o+2],g=r[o+3];if(u!==g||l!==f||c!==d||h!==m){let y=l*f+c*d+h*m+u*g;y<0&&(f=-f,d=-d,m=-m,g=-g,y=-y);let _=1-a;if(y<.9995){let w=Math.acos(y),A=Math.sin(w);_=Math.sin(_*w)/A,a=Math.sin(a*w)/A,l=l*_+f*a,c=c*_+d*a,h=h*_+m*a,u=u*_+g*a}else{l=l*_+f*a,c=c*_+d*a,h=h*_+m*a,u=u*_+g*a;let w=1/Math.sqrt(l*l+c*c+h*h+u*u);l*=w,c*=w,h*=w,u*=w}}e[t]=l,e[t+1]=c,e[t+2]=h,e[t+3]=u}static multiplyQuaternionsFlat(e,t,i,n,r,o){let a=i[n],l=i[n+1],c=i[n+2],h=i[n+3],u=r[o],f=r[o+1],d=r[o+2],m=r[o+3];return e[t]=a*m+h*u+l*d-c*f,e[t+1]=l*m+h*f+c*u-a*d,e[t+2]=c*m+h*d+a*f-l*u,e[t+3]=h*m-a*u-l*f-c*d,e}get x(){return this._x}set x(e){this._x=e,this._onChangeCallback()}get y(){return this._y}set y(e){this._y=e,this._onChangeCallback()}get z(){return this._z}set z(e){this._z=e,this._onChangeCallback()}get w(){return this._w}set w(e){this._w=e,this._onChangeCallback()}set(e,t,i,n){return this._x=e,this._y=t,this._z=i,this._w=n,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._w)}copy(e){return this._x=e.x,this._y=e.y,this._z=e.z,this._w=e.w,this._onChangeCallback(),this}setFromEuler(e,t=!0){let i=e._x,n=e._y,r=e._z,o=e._order,a=Math.cos,l=Math.sin,c=a(i/2),h=a(n/2),u=a(r/2),f=l(i/2),d=l(n/2),m=l(r/2);switch(o){case"XYZ":this._x=f*h*u+c*d*m,this._y=c*d*u-f*h*m,this._z=c*h*m+f*d*u,this._w=c*h*u-f*d*m;break;case"YXZ":this._x=f*h*u+c*d*m,this._y=c*d*u-f*h*m,this._z=c*h*m-f*d*u,this._w=c*h*u+f*d*m;break;case"ZXY":this._x=f*h*u-c*d*m,this._y=c*d*u+f*h*m,this._z=c*h*m+f*d*u,this._w=c*h*u-f*d*m;break;case"ZYX":this._x=f*h*u-c*d*m,this._y=c*d*u+f*h*m,this._z=c*h*m-f*d*u,this._w=c*h*u+f*d*m;break;case"YZX":this._x=f*h*u+c*d*m,this._y=c*d*u+f*h*m,this._z=c*h*m-f*d*u,this._w=c*h*u-f*d*m;break;case"XZY":this._x=f*h*u-c*d*m,this._y=c*d*u-f*h*m,this._z=c*h*m+f*d*u,this._w=c*h*u+f*d*m;break;default:It("Quaternion: .setFromEuler() encountered an unknown order: "+o)}return t===!0&&this._onChangeCallback(),this}setFromAxisAngle(e,t){let i=t/2,n=Math.sin(i);return this._x=e.x*n,this._y=e.y*n,this._z=e.z*n,this._w=Math.cos(i),this._onChangeCallback(),this}setFromRotationMatrix(e){let t=e.elements,i=t[0],n=t[4],r=t[8],o=t[1],a=t[5],l=t[9],c=t[2],h=t[6],u=t[10],f=i+a+u;if(f>0){let d=.5/Math.sqrt(f+1);this._w=.25/d,this._x=(h-l)*d,this._y=(r-c)*d,this._z=(o-n)*d}else if(i>a&&i>u){let d=2*Math.sqrt(1+i-a-u);this._w=(h-l)/d,this._x=.25*d,this._y=(n+o)/d,this._z=(r+c)/d}else if(a>u){let d=2*Math.sqrt(1+a-i-u);this._w=(r-c)/d,this._x=(n+o)/d,this._y=.25*d,this._z=(l+h)/d}else{let d=2*Math.sqrt(1+u-i-a);this._w=(o-n)/d,this._x=(r+c)/d,this._y=(l+h)/d,this._z=.25*d}return this._onChangeCallback(),this}setFromUnitVectors(e,t){let i=e.dot(t)+1;return i<1e-8?(i=0,Math.abs(e.x)>Math.abs(e.z)?(this._x=-e.y,this._y=e.x,this._z=0,this._w=i):(this._x=0,this._y=-e.z,this._z=e.y,this._w=i)):(this._x=e.y*t.z-e.z*t.y,this._y=e.z*t.x-e.x*t.z,this._z=e.x*t.y-e.y*t.x,this._w=i),this.normalize()}angleTo(e){return 2*Math.acos(Math.abs(_e(this.dot(e),-1,1)))}rotateTowards(e,t){let i=this.angleTo(e);if(i===0)return this;let n=Math.min(1,t/i);return this.slerp(e,n),this}identity(){return this.set(0,0,0,1)}invert(){return this.conjugate()}conjugate(){return this._x*=-1,this._y*=-1,this._z*=-1,this._onChangeCallback(),this}dot(e){return this._x*e._x+this._y*e._y+this._z*e._z+this._w*e._w}lengthSq(){return this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w}length(){return Math.sqrt(this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w)}normalize(){let e=this.length();return e===0?(this._x=0,this._y=0,this._z=0,this._w=1):(e=1/e,this._x=this._x*e,this._y=this._y*e,this._z=this._z*e,this._w=this._w*e),this._onChangeCallback(),this}multiply(e){return this.multiplyQuaternions(this,e)}premultiply(e){return this.multiplyQuaternions(e,this)}multiplyQuaternions(e,t){let i=e._x,n=e._y,r=e._z,o=e._w,a=t._x,l=t._y,c=t._z,h=t._w;return this._x=i*h+o*a+n*c-r*l,this._y=n*h+o*l+r*a-i*c,this._z=r*h+o*c+i*l-n*a,this._w=o*h-i*a-n*l-r*c,this._onChangeCallback(),this}slerp(e,t){let i=e._x,n=e._y,r=e._z,o=e._w,a=this.dot(e);a<0&&(i=-i,n=-n,r=-r,o=-o,a=-a);let l=1-t;if(a<.9995){let c=Math.acos(a),h=Math.sin(c);l=Math.sin(l*c)/h,t=Math.sin(t*c)/h,this._x=this._x*l+i*t,this._y=this._y*l+n*t,this._z=this._z*l+r*t,this._w=this._w*l+o*t,this._onChangeCallback()}else this._x=this._x*l+i*t,this._y=this._y*l+n*t,this._z=this._z*l+r*t,this._w=this._w*l+o*t,this.normalize();return this}slerpQuaternions(e,t,i){return this.copy(e).slerp(t,i)}random(){let e=2*Math.PI*Math.random(),t=2*Math.PI*Math.random(),i=Math.random(),n=Math.sqrt(1-i),r=Math.sqrt(i);return this.set(n*Math.sin(e),n*Math.cos(e),r*Math.sin(t),r*Math.cos(t))}equals(e){return e._x===this._x&&e._y===this._y&&e._z===this._z&&e._w===this._w}fromArray(e,t=0){return this._x=e[t],this._y=e[t+1],this._z=e[t+2],this._w=e[t+3],this._onChangeCallback(),this}toArray(e=[],t=0){return e[t]=this._x,e[t+1]=this._y,e[t+2]=this._z,e[t+3]=this._w,e}fromBufferAttribute(e,t){return this._x=e.getX(t),this._y=e.getY(t),this._z=e.getZ(t),this._w=e.getW(t),this._onChangeCallback(),this}toJSON(){return this.toArray()}_onChange(e){return this._onChangeCallback=e,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._w}},it=class{static{this.prototype.isVector3=!0}constructor(e=0,t=0,i=0){this.x=e,this.y=t,this.z=i}set(e,t,i){return i===void 0&&(i=this.z),this.x=e,this.y=t,this.z=i,this}setScalar(e){return this.x=e,this.y=e,this.z=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setZ(e){return this.z=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;case 2:this.z=t;break;default:throw new Error("THREE.Vector3: index is out of range: "+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;case 2:return this.z;default:throw new Error("THREE.Vector3: index is out of range: "+e)}}clone(){return new this.constructor(this.x,this.y,this.z)}copy(e){return this.x=e.x,this.y=e.y,this.z=e.z,this}add(e){return this.x+=e.x,this.y+=e.y,this.z+=e.z,this}addScalar(e){return this.x+=e,this.y+=e,this.z+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this.z=e.z+t.z,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this.z+=e.z*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this.z-=e.z,this}subScalar(e){return this.x-=e,this.y-=e,this.z-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this.z=e.z-t.z,this}multiply(e){return this.x*=e.x,this.y*=e.y,this.z*=e.z,this}multiplyScalar(e){return this.x*=e,this.y*=e,this.z*=e,this}multiplyVectors(e,t){return this.x=e.x*t.x,this.y=e.y*t.y,this.z=e.z*t.z,this}applyEuler(e){return this.applyQuaternion(Qy.setFromEuler(e))}applyAxisAngle(e,t){return this.applyQuaternion(Qy.setFromAxisAngle(e,t))}applyMatrix3(e){let t=this.x,i=this.y,n=this.z,r=e.elements;return this.x=r[0]*t+r[3]*i+r[6]*n,this.y=r[1]*t+r[4]*i+r[7]*n,this.z=r[2]*t+r[5]*i+r[8]*n,this}applyNormalMatrix(e){return this.applyMatrix3(e).normalize()}applyMatrix4(e){let t=this.x,i=this.y,n=this.z,r=e.elements,o=1/(r[3]*t+r[7]*i+r[11]*n+r[15]);return this.x=(r[0]*t+r[4]*i+r[8]*n+r[12])*o,this.y=(r[1]*t+r[5]*i+r[9]*n+r[13])*o,this.z=(r[2]*t+r[6]*i+r[10]*n+r[14])*o,this}applyQuaternion(e){let t=this.x,i=this.y,n=this.z,r=e.x,o=e.y,a=e.z,l=e.w,c=2*(o*n-a*i),h=2*(a*t-r*n),u=2*(r*i-o*t);return this.x=t+l*c+o*u-a*h,this.y=i+l*h+a*c-r*u,this.z=n+l*u+r*h-o*c,this}project(e){return this.applyMatrix4(e.matrixWorldInverse).applyMatrix4(e.projectionMatrix)}unproject(e){return this.applyMatrix4(e.projectionMatrixInverse).applyMatrix4(e.matrixWorld)}transformDirection(e){let t=this.x,i=this.y,n=this.z,r=e.elements;return this.x=r[0]*t+r[4]*i+r[8]*n,this.y=r[1]*t+r[5]*i+r[9]*n,this.z=r[2]*t+r[6]*i+r[10]*n,this.normalize()}divide(e){return this.x/=e.x,this.y/=e.y,this.z/=e.z,this}divideScalar(e){return this.multiplyScalar(1/e)}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this.z=Math.min(this.z,e.z),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this.z=Math.max(this.z,e.z),this}clamp(e,t){return this.x=_e(this.x,e.x,t.x),this.y=_e(this.y,e.y,t.y),this.z=_e(this.z,e.z,t.z),this}clampScalar(e,t){return this.x=_e(this.x,e,t),this.y=_e(this.y,e,t),this.z=_e(this.z,e,t),this}clampLength(e,t){let i=this.length();return this.divideScalar(i||1).multiplyScalar(_e(i,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this}dot(e){return this.x*e.x+this.y*e.y+this.z*e.z}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)}normalize(){return this.divideScalar(this.length()||1)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this.z+=(e.z-this.z)*t,this}lerpVectors(e,t,i){return this.x=e.x+(t.x-e.x)*i,this.y=e.y+(t.y-e.y)*i,this.z=e.z+(t.z-e.z)*i,this}cross(e){return this.crossVectors(this,e)}crossVectors(e,t){let i=e.x,n=e.y,r=e.z,o=t.x,a=t.y,l=t.z;return this.x=n*l-r*a,this.y=r*o-i*l,this.z=i*a-n*o,this}projectOnVector(e){let t=e.lengthSq();if(t===0)return this.set(0,0,0);let i=e.dot(this)/t;return this.copy(e).multiplyScalar(i)}projectOnPlane(e){return Od.copy(this).projectOnVector(e),this.sub(Od)}reflect(e){return this.sub(Od.copy(e).multiplyScalar(2*this.dot(e)))}angleTo(e){let t=Math.sqrt(this.lengthSq()*e.lengthSq());if(t===0)return Math.PI/2;let i=this.dot(e)/t;return Math.acos(_e(i,-1,1))}distanceTo(e){return Math.sqrt(this.distanceToSquared(e))}distanceToSquared(e){let t=this.x-e.x,i=this.y-e.y,n=this.z-e.z;return t*t+i*i+n*n}manhattanDistanceTo(e){return Math.abs(this.x-e.x)+Math.abs(this.y-e.y)+Math.abs(this.z-e.z)}setFromSpherical(e){return this.setFromSphericalCoords(e.radius,e.phi,e.theta)}setFromSphericalCoords(e,t,i){let n=Math.sin(t)*e;return this.x=n*Math.sin(i),this.y=Math.cos(t)*e,this.z=n*Math.cos(i),this}setFromCylindrical(e){return this.setFromCylindricalCoords(e.radius,e.theta,e.y)}setFromCylindricalCoords(e,t,i){return this.x=e*Math.sin(t),this.y=i,this.z=e*Math.cos(t),this}setFromMatrixPosition(e){let t=e.elements;return this.x=t[12],this.y=t[13],this.z=t[14],this}setFromMatrixScale(e){let t=this.setFromMatrixColumn(e,0).length(),i=this.setFromMatrixColumn(e,1).length(),n=this.setFromMatrixColumn(e,2).length();return this.x=t,this.y=i,this.z=n,this}setFromMatrixColumn(e,t){return this.fromArray(e.elements,t*4)}setFromMatrix3Column(e,t){return this.fromArray(e.elements,t*3)}setFromEuler(e){return this.x=e._x,this.y=e._y,this.z=e._z,this}setFromColor(e){return this.x=e.r,this.y=e.g,this.z=e.b,this}equals(e){return e.x===this.x&&e.y===this.y&&e.z===this.z}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this.z=e[t+2],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e[t+2]=this.z,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this.z=e.getZ(t),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this}randomDirection(){let e=Math.random()*Math.PI*2,t=Math.random()*2-1,i=Math.sqrt(1-t*t);return this.x=i*Math.cos(e),this.y=t,this.z=i*Math.sin(e),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z}},Od=new it,Qy=new Tn,pe=class{static{this.prototype.isMatrix3=!0}constructor(e,t,i,n,r,o,a,l,c){this.elements=[1,0,0,0,1,0,0,0,1],e!==void 0&&this.set(e,t,i,n,r,o,a,l,c)}set(e,t,i,n,r,o,a,l,c){let h=this.elements;return h[0]=e,h[1]=n,h[2]=a,h[3]=t,h[4]=r,h[5]=l,h[6]=i,h[7]=o,h[8]=c,this}identity(){return this.set(1,0,0,0,1,0,0,0,1),this}copy(e){let t=this.elements,i=e.elements;return t[0]=i[0],t[1]=i[1],t[2]=i[2],t[3]=i[3],t[4]=i[4],t[5]=i[5],t[6]=i[6],t[7]=i[7],t[8]=i[8],this}extractBasis(e,t,i){return e.setFromMatrix3Column(this,0),t.setFromMatrix3Column(this,1),i.setFromMatrix3Column(this,2),this}setFromMatrix4(e){let t=e.elements;return this.set(t[0],t[4],t[8],t[1],t[5],t[9],t[2],t[6],t[10]),this}multiply(e){return this.multiplyMatrices(this,e)}premultiply(e){return this.multiplyMatrices(e,this)}multiplyMatrices(e,t){let i=e.elements,n=t.elements,r=this.elements,o=i[0],a=i[3],l=i[6],c=i[1],h=i[4],u=i[7],f=i[2],d=i[5],m=i[8],g=n[0],y=n[3],_=n[6],w=n[1],A=n[4],T=n[7],C=n[2],E=n[5],P=n[8];return r[0]=o*g+a*w+l*C,r[3]=o*y+a*A+l*E,r[6]=o*_+a*T+l*P,r[1]=c*g+h*w+u*C,r[4]=c*y+h*A+u*E,r[7]=c*_+h*T+u*P,r[2]=f*g+d*w+m*C,r[5]=f*y+d*A+m*E,r[8]=f*_+d*T+m*P,this}multiplyScalar(e){let t=this.elements;return t[0]*=e,t[3]*=e,t[6]*=e,t[1]*=e,t[4]*=e,t[7]*=e,t[2]*=e,t[5]*=e,t[8]*=e,this}determinant(){let e=this.elements,t=e[0],i=e[1],n=e[2],r=e[3],o=e[4],a=e[5],l=e[6],c=e[7],h=e[8];return t*o*h-t*a*c-i*r*h+i*a*l+n*r*c-n*o*l}invert(){let e=this.elements,t=e[0],i=e[1],n=e[2],r=e[3],o=e[4],a=e[5],l=e[6],c=e[7],h=e[8],u=h*o-a*c,f=a*l-h*r,d=c*r-o*l,m=t*u+i*f+n*d;if(m===0)return this.set(0,0,0,0,0,0,0,0,0);let g=1/m;return e[0]=u*g,e[1]=(n*c-h*i)*g,e[2]=(a*i-n*o)*g,e[3]=f*g,e[4]=(h*t-n*l)*g,e[5]=(n*r-a*t)*g,e[6]=d*g,e[7]=(i*l-c*t)*g,e[8]=(o*t-i*r)*g,this}transpose(){let e,t=this.elements;return e=t[1],t[1]=t[3],t[3]=e,e=t[2],t[2]=t[6],t[6]=e,e=t[5],t[5]=t[7],t[7]=e,this}getNormalMatrix(e){return this.setFromMatrix4(e).invert().transpose()}transposeIntoArray(e){let t=this.elements;return e[0]=t[0],e[1]=t[3],e[2]=t[6],e[3]=t[1],e[4]=t[4],e[5]=t[7],e[6]=t[2],e[7]=t[5],e[8]=t[8],this}setUvTransform(e,t,i,n,r,o,a){let l=Math.cos(r),c=Math.sin(r);return this.set(i*l,i*c,-i*(l*o+c*a)+o+e,-n*c,n*l,-n*(-c*o+l*a)+a+t,0,0,1),this}scale(e,t){return Bc("Matrix3: .scale() is deprecated. Use .makeScale() instead."),this.premultiply(Fd.makeScale(e,t)),this}rotate(e){return Bc("Matrix3: .rotate() is deprecated. Use .makeRotation() instead."),this.premultiply(Fd.makeRotation(-e)),this}translate(e,t){return Bc("Matrix3: .translate() is deprecated. Use .makeTranslation() instead."),this.premultiply(Fd.makeTranslation(e,t)),this}makeTranslation(e,t){return e.isVector2?this.set(1,0,e.x,0,1,e.y,0,0,1):this.set(1,0,e,0,1,t,0,0,1),this}makeRotation(e){let t=Math.cos(e),i=Math.sin(e);return this.set(t,-i,0,i,t,0,0,0,1),this}makeScale(e,t){return this.set(e,0,0,0,t,0,0,0,1),this}equals(e){let t=this.elements,i=e.elements;for(let n=0;n<9;n++)if(t[n]!==i[n])return!1;return!0}fromArray(e,t=0){for(let i=0;i<9;i++)this.elements[i]=e[i+t];return this}toArray(e=[],t=0){let i=this.elements;return e[t]=i[0],e[t+1]=i[1],e[t+2]=i[2],e[t+3]=i[3],e[t+4]=i[4],e[t+5]=i[5],e[t+6]=i[6],e[t+7]=i[7],e[t+8]=i[8],e}clone(){return new this.constructor().fromArray(this.elements)}},Fd=new pe,eb=new pe().set(.4123908,.3575843,.1804808,.212639,.7151687,.0721923,.0193308,.1191948,.9505322),tb=new pe().set(3.2409699,-1.5373832,-.4986108,-.9692436,1.8759675,.0415551,.0556301,-.203977,1.0569715);function ME(){let s={enabled:!0,workingColorSpace:ip,spaces:{},convert:function(n,r,o){return this.enabled===!1||r===o||!r||!o||(this.spaces[r].transfer===Fc&&(n.r=Mn(n.r),n.g=Mn(n.g),n.b=Mn(n.b)),this.spaces[r].primaries!==this.spaces[o].primaries&&(n.applyMatrix3(this.spaces[r].toXYZ),n.applyMatrix3(this.spaces[o].fromXYZ)),this.spaces[o].transfer===Fc&&(n.r=Zr(n.r),n.g=Zr(n.g),n.b=Zr(n.b))),n},workingToColorSpace:function(n,r){return this.convert(n,this.workingColorSpace,r)},colorSpaceToWorking:function(n,r){return this.convert(n,r,this.workingColorSpace)},getPrimaries:function(n){return this.spaces[n].primaries},getTransfer:function(n){return n===xp?np:this.spaces[n].transfer},getToneMappingMode:function(n){return this.spaces[n].outputColorSpaceConfig.toneMappingMode||"standard"},getLuminanceCoefficients:function(n,r=this.workingColorSpace){return n.fromArray(this.spaces[r].luminanceCoefficients)},define:function(n){Object.assign(this.spaces,n)},_getMatrix:function(n,r,o){return n.copy(this.spaces[o].fromXYZ).multiply(this.spaces[r].toXYZ)},_getDrawingBufferColorSpace:function(n){return this.spaces[n].outputColorSpaceConfig.drawingBufferColorSpace},_getUnpackColorSpace:function(n=this.workingColorSpace){return this.spaces[n].workingColorSpaceConfig.unpackColorSpace}},e=[.64,.33,.3,.6,.15,.06],t=[.2126,.7152,.0722],i=[.3127,.329];return s.define({[ip]:{primaries:e,whitePoint:i,transfer:np,toXYZ:eb,fromXYZ:tb,luminanceCoefficients:t,workingColorSpaceConfig:{unpackColorSpace:Ri},outputColorSpaceConfig:{drawingBufferColorSpace:Ri}},[Ri]:{primaries:e,whitePoint:i,transfer:Fc,toXYZ:eb,fromXYZ:tb,luminanceCoefficients:t,outputColorSpaceConfig:{drawingBufferColorSpace:Ri}}}),s}var Ci=ME();function Mn(s){return s<.04045?s*.0773993808:Math.pow(s*.9478672986+.0521327014,2.4)}function Zr(s){return s<.0031308?s*12.92:1.055*Math.pow(s,.41666)-.055}var Xr,Vc=class{static getDataURL(e,t="image/png"){if(/^data:/i.test(e.src)||typeof HTMLCanvasElement>"u")return e.src;let i;if(e instanceof HTMLCanvasElement)i=e;else{Xr===void 0&&(Xr=rp("canvas")),Xr.width=e.width,Xr.height=e.height;let n=Xr.getContext("2d");e instanceof ImageData?n.putImageData(e,0,0):n.drawImage(e,0,0,e.width,e.height),i=Xr}return i.toDataURL(t)}static sRGBToLinear(e){if(typeof HTMLImageElement<"u"&&e instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&e instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&e instanceof ImageBitmap){let t=rp("canvas");t.width=e.width,t.height=e.height;let i=t.getContext("2d");i.drawImage(e,0,0,e.width,e.height);let n=i.getImageData(0,0,e.width,e.height),r=n.data;for(let o=0;o<r.length;o++)r[o]=Mn(r[o]/255)*255;return i.putImageData(n,0,0),t}else if(e.data){let t=e.data.slice(0);for(let i=0;i<t.length;i++)t instanceof Uint8Array||t instanceof Uint8ClampedArray?t[i]=Math.floor(Mn(t[i]/255)*255):t[i]=Mn(t[i]);return{data:t,width:e.width,height:e.height}}else return It("ImageUtils.sRGBToLinear(): Unsupported image type. No color space conversion applied."),e}},AE=0,Hc=class{constructor(e=null){this.isTextureSource=!0,Object.defineProperty(this,"id",{value:AE++}),this.uuid=vp(),this.data=e,this.dataReady=!0,this.version=0}getSize(e){let t=this.data;return typeof HTMLVideoElement<"u"&&t instanceof HTMLVideoElement?e.set(t.videoWidth,t.videoHeight,0):typeof VideoFrame<"u"&&t instanceof VideoFrame?e.set(t.displayWidth,t.displayHeight,0):t!==null?e.set(t.width||0,t.height||0,t.depth||0):e.set(0,0,0),e}set needsUpdate(e){e===!0&&this.version++}toJSON(e){let t=e===void 0||typeof e=="string";if(!t&&e.images[this.uuid]!==void 0)return e.images[this.uuid];let i={uuid:this.uuid,url:""},n=this.data;if(n!==null){let r;if(Array.isArray(n)){r=[];for(let o=0,a=n.length;o<a;o++)n[o].isDataTexture?r.push(Bd(n[o].image)):r.push(Bd(n[o]))}else r=Bd(n);i.url=r}return t||(e.images[this.uuid]=i),i}};function Bd(s){return typeof HTMLImageElement<"u"&&s instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&s instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&s instanceof ImageBitmap?Vc.getDataURL(s):s.data?{data:Array.from(s.data),width:s.width,height:s.height,type:s.data.constructor.name}:(It("Texture: Unable to serialize Texture."),{})}var TE=0,Ud=new it,jr=class s extends ca{constructor(e=s.DEFAULT_IMAGE,t=s.DEFAULT_MAPPING,i=oa,n=oa,r=vb,o=yb,a=_b,l=bb,c=s.DEFAULT_ANISOTROPY,h=xp){super(),this.isTexture=!0,Object.defineProperty(this,"id",{value:TE++}),this.uuid=vp(),this.name="",this.source=new Hc(e),this.mipmaps=[],this.mapping=t,this.channel=0,this.wrapS=i,this.wrapT=n,this.magFilter=r,this.minFilter=o,this.anisotropy=c,this.format=a,this.internalFormat=null,this.type=l,this.offset=new Yi(0,0),this.repeat=new Yi(1,1),this.center=new Yi(0,0),this.rotation=0,this.matrixAutoUpdate=!0,this.matrix=new pe,this.generateMipmaps=!0,this.mipmapsAutoUpdate=!0,this.premultiplyAlpha=!1,this.flipY=!0,this.unpackAlignment=4,this.colorSpace=h,this.userData={},this.updateRanges=[],this.version=0,this.onUpdate=null,this.renderTarget=null,this.isRenderTargetTexture=!1,this.isArrayTexture=!!(e&&e.depth&&e.depth>1),this.pmremVersion=0,this.isPMREMTexture=!1,this.normalized=!1}get width(){return this.source.getSize(Ud).x}get height(){return this.source.getSize(Ud).y}get depth(){return this.source.getSize(Ud).z}get image(){return this.source.data}set image(e){this.source.data=e}updateMatrix(){this.matrix.setUvTransform(this.offset.x,this.offset.y,this.repeat.x,this.repeat.y,this.rotation,this.center.x,this.center.y)}addUpdateRange(e,t){this.updateRanges.push({start:e,count:t})}clearUpdateRanges(){this.updateRanges.length=0}clone(){return new this.constructor().copy(this)}copy(e){return this.name=e.name,this.source=e.source,this.mipmaps=e.mipmaps.slice(0),this.mapping=e.mapping,this.channel=e.channel,this.wrapS=e.wrapS,this.wrapT=e.wrapT,this.magFilter=e.magFilter,this.minFilter=e.minFilter,this.anisotropy=e.anisotropy,this.format=e.format,this.internalFormat=e.internalFormat,this.type=e.type,this.normalized=e.normalized,this.offset.copy(e.offset),this.repeat.copy(e.repeat),this.center.copy(e.center),this.rotation=e.rotation,this.matrixAutoUpdate=e.matrixAutoUpdate,this.matrix.copy(e.matrix),this.generateMipmaps=e.generateMipmaps,this.mipmapsAutoUpdate=e.mipmapsAutoUpdate,this.premultiplyAlpha=e.premultiplyAlpha,this.flipY=e.flipY,this.unpackAlignment=e.unpackAlignment,this.colorSpace=e.colorSpace,this.renderTarget=e.renderTarget,this.isRenderTargetTexture=e.isRenderTargetTexture,this.isPMREMTexture=e.isPMREMTexture,this.isArrayTexture=e.isArrayTexture,this.userData=JSON.parse(JSON.stringify(e.userData)),this.needsUpdate=!0,this}setValues(e){for(let t in e){let i=e[t];if(i===void 0){It(`Texture.setValues(): parameter '${t}' has value of undefined.`);continue}let n=this[t];if(n===void 0){It(`Texture.setValues(): property '${t}' does not exist.`);continue}n&&i&&n.isVector2&&i.isVector2||n&&i&&n.isVector3&&i.isVector3||n&&i&&n.isMatrix3&&i.isMatrix3?n.copy(i):this[t]=i}}toJSON(e){let t=e===void 0||typeof e=="string";if(!t&&e.textures[this.uuid]!==void 0)return e.textures[this.uuid];let i={metadata:{version:4.7,type:"Texture",generator:"Texture.toJSON"},uuid:this.uuid,name:this.name,image:this.source.toJSON(e).uuid,mapping:this.mapping,channel:this.channel,repeat:[this.repeat.x,this.repeat.y],offset:[this.offset.x,this.offset.y],center:[this.center.x,this.center.y],rotation:this.rotation,wrap:[this.wrapS,this.wrapT],format:this.format,internalFormat:this.internalFormat,type:this.type,normalized:this.normalized,colorSpace:this.colorSpace,minFilter:this.minFilter,magFilter:this.magFilter,anisotropy:this.anisotropy,flipY:this.flipY,generateMipmaps:this.generateMipmaps,mipmapsAutoUpdate:this.mipmapsAutoUpdate,premultiplyAlpha:this.premultiplyAlpha,unpackAlignment:this.unpackAlignment};return Object.keys(this.userData).length>0&&(i.userData=this.userData),t||(e.textures[this.uuid]=i),i}dispose(){this.dispatchEvent({type:"dispose"})}transformUv(e){if(this.mapping!==gp)return e;if(e.applyMatrix3(this.matrix),e.x<0||e.x>1)switch(this.wrapS){case Jd:e.x=e.x-Math.floor(e.x);break;case oa:e.x=e.x<0?0:1;break;case Zd:Math.abs(Math.floor(e.x)%2)===1?e.x=Math.ceil(e.x)-e.x:e.x=e.x-Math.floor(e.x);break}if(e.y<0||e.y>1)switch(this.wrapT){case Jd:e.y=e.y-Math.floor(e.y);break;case oa:e.y=e.y<0?0:1;break;case Zd:Math.abs(Math.floor(e.y)%2)===1?e.y=Math.ceil(e.y)-e.y:e.y=e.y-Math.floor(e.y);break}return this.flipY&&(e.y=1-e.y),e}set needsUpdate(e){e===!0&&(this.version++,this.source.needsUpdate=!0)}set needsPMREMUpdate(e){e===!0&&this.pmremVersion++}};jr.DEFAULT_IMAGE=null;jr.DEFAULT_MAPPING=gp;jr.DEFAULT_ANISOTROPY=1;var op=class{static{this.prototype.isVector4=!0}constructor(e=0,t=0,i=0,n=1){this.x=e,this.y=t,this.z=i,this.w=n}get width(){return this.z}set width(e){this.z=e}get height(){return this.w}set height(e){this.w=e}set(e,t,i,n){return this.x=e,this.y=t,this.z=i,this.w=n,this}setScalar(e){return this.x=e,this.y=e,this.z=e,this.w=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setZ(e){return this.z=e,this}setW(e){return this.w=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;case 2:this.z=t;break;case 3:this.w=t;break;default:throw new Error("THREE.Vector4: index is out of range: "+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;case 2:return this.z;case 3:return this.w;default:throw new Error("THREE.Vector4: index is out of range: "+e)}}clone(){return new this.constructor(this.x,this.y,this.z,this.w)}copy(e){return this.x=e.x,this.y=e.y,this.z=e.z,this.w=e.w!==void 0?e.w:1,this}add(e){return this.x+=e.x,this.y+=e.y,this.z+=e.z,this.w+=e.w,this}addScalar(e){return this.x+=e,this.y+=e,this.z+=e,this.w+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this.z=e.z+t.z,this.w=e.w+t.w,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this.z+=e.z*t,this.w+=e.w*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this.z-=e.z,this.w-=e.w,this}subScalar(e){return this.x-=e,this.y-=e,this.z-=e,this.w-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this.z=e.z-t.z,this.w=e.w-t.w,this}multiply(e){return this.x*=e.x,this.y*=e.y,this.z*=e.z,this.w*=e.w,this}multiplyScalar(e){return this.x*=e,this.y*=e,this.z*=e,this.w*=e,this}applyMatrix4(e){let t=this.x,i=this.y,n=this.z,r=this.w,o=e.elements;return this.x=o[0]*t+o[4]*i+o[8]*n+o[12]*r,this.y=o[1]*t+o[5]*i+o[9]*n+o[13]*r,this.z=o[2]*t+o[6]*i+o[10]*n+o[14]*r,this.w=o[3]*t+o[7]*i+o[11]*n+o[15]*r,this}divide(e){return this.x/=e.x,this.y/=e.y,this.z/=e.z,this.w/=e.w,this}divideScalar(e){return this.multiplyScalar(1/e)}setAxisAngleFromQuaternion(e){this.w=2*Math.acos(e.w);let t=Math.sqrt(1-e.w*e.w);return t<1e-4?(this.x=1,this.y=0,this.z=0):(this.x=e.x/t,this.y=e.y/t,this.z=e.z/t),this}setAxisAngleFromRotationMatrix(e){let t,i,n,r,l=e.elements,c=l[0],h=l[4],u=l[8],f=l[1],d=l[5],m=l[9],g=l[2],y=l[6],_=l[10];if(Math.abs(h-f)<.01&&Math.abs(u-g)<.01&&Math.abs(m-y)<.01){if(Math.abs(h+f)<.1&&Math.abs(u+g)<.1&&Math.abs(m+y)<.1&&Math.abs(c+d+_-3)<.1)return this.set(1,0,0,0),this;t=Math.PI;let A=(c+1)/2,T=(d+1)/2,C=(_+1)/2,E=(h+f)/4,P=(u+g)/4,O=(m+y)/4;return A>T&&A>C?A<.01?(i=0,n=.707106781,r=.707106781):(i=Math.sqrt(A),n=E/i,r=P/i):T>C?T<.01?(i=.707106781,n=0,r=.707106781):(n=Math.sqrt(T),i=E/n,r=O/n):C<.01?(i=.707106781,n=.707106781,r=0):(r=Math.sqrt(C),i=P/r,n=O/r),this.set(i,n,r,t),this}let w=Math.sqrt((y-m)*(y-m)+(u-g)*(u-g)+(f-h)*(f-h));return Math.abs(w)<.001&&(w=1),this.x=(y-m)/w,this.y=(u-g)/w,this.z=(f-h)/w,this.w=Math.acos((c+d+_-1)/2),this}setFromMatrixPosition(e){let t=e.elements;return this.x=t[12],this.y=t[13],this.z=t[14],this.w=t[15],this}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this.z=Math.min(this.z,e.z),this.w=Math.min(this.w,e.w),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this.z=Math.max(this.z,e.z),this.w=Math.max(this.w,e.w),this}clamp(e,t){return this.x=_e(this.x,e.x,t.x),this.y=_e(this.y,e.y,t.y),this.z=_e(this.z,e.z,t.z),this.w=_e(this.w,e.w,t.w),this}clampScalar(e,t){return this.x=_e(this.x,e,t),this.y=_e(this.y,e,t),this.z=_e(this.z,e,t),this.w=_e(this.w,e,t),this}clampLength(e,t){let i=this.length();return this.divideScalar(i||1).multiplyScalar(_e(i,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this.w=Math.floor(this.w),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this.w=Math.ceil(this.w),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this.w=Math.round(this.w),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this.w=Math.trunc(this.w),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this.w=-this.w,this}dot(e){return this.x*e.x+this.y*e.y+this.z*e.z+this.w*e.w}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)+Math.abs(this.w)}normalize(){return this.divideScalar(this.length()||1)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this.z+=(e.z-this.z)*t,this.w+=(e.w-this.w)*t,this}lerpVectors(e,t,i){return this.x=e.x+(t.x-e.x)*i,this.y=e.y+(t.y-e.y)*i,this.z=e.z+(t.z-e.z)*i,this.w=e.w+(t.w-e.w)*i,this}equals(e){return e.x===this.x&&e.y===this.y&&e.z===this.z&&e.w===this.w}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this.z=e[t+2],this.w=e[t+3],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e[t+2]=this.z,e[t+3]=this.w,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this.z=e.getZ(t),this.w=e.getW(t),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this.w=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z,yield this.w}};var An=class s{static{this.prototype.isMatrix4=!0}constructor(e,t,i,n,r,o,a,l,c,h,u,f,d,m,g,y){this.elements=[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],e!==void 0&&this.set(e,t,i,n,r,o,a,l,c,h,u,f,d,m,g,y)}set(e,t,i,n,r,o,a,l,c,h,u,f,d,m,g,y){let _=this.elements;return _[0]=e,_[4]=t,_[8]=i,_[12]=n,_[1]=r,_[5]=o,_[9]=a,_[13]=l,_[2]=c,_[6]=h,_[10]=u,_[14]=f,_[3]=d,_[7]=m,_[11]=g,_[15]=y,this}identity(){return this.set(1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1),this}clone(){return new s().fromArray(this.elements)}copy(e){let t=this.elements,i=e.elements;return t[0]=i[0],t[1]=i[1],t[2]=i[2],t[3]=i[3],t[4]=i[4],t[5]=i[5],t[6]=i[6],t[7]=i[7],t[8]=i[8],t[9]=i[9],t[10]=i[10],t[11]=i[11],t[12]=i[12],t[13]=i[13],t[14]=i[14],t[15]=i[15],this}copyPosition(e){let t=this.elements,i=e.elements;return t[12]=i[12],t[13]=i[13],t[14]=i[14],this}setFromMatrix3(e){let t=e.elements;return this.set(t[0],t[3],t[6],0,t[1],t[4],t[7],0,t[2],t[5],t[8],0,0,0,0,1),this}extractBasis(e,t,i){return this.determinantAffine()===0?(e.set(1,0,0),t.set(0,1,0),i.set(0,0,1),this):(e.setFromMatrixColumn(this,0),t.setFromMatrixColumn(this,1),i.setFromMatrixColumn(this,2),this)}makeBasis(e,t,i){return this.set(e.x,t.x,i.x,0,e.y,t.y,i.y,0,e.z,t.z,i.z,0,0,0,0,1),this}extractRotation(e){if(e.determinantAffine()===0)return this.identity();let t=this.elements,i=e.elements,n=1/$r.setFromMatrixColumn(e,0).length(),r=1/$r.setFromMatrixColumn(e,1).length(),o=1/$r.setFromMatrixColumn(e,2).length();return t[0]=i[0]*n,t[1]=i[1]*n,t[2]=i[2]*n,t[3]=0,t[4]=i[4]*r,t[5]=i[5]*r,t[6]=i[6]*r,t[7]=0,t[8]=i[8]*o,t[9]=i[9]*o,t[10]=i[10]*o,t[11]=0,t[12]=0,t[13]=0,t[14]=0,t[15]=1,this}makeRotationFromEuler(e){let t=this.elements,i=e.x,n=e.y,r=e.z,o=Math.cos(i),a=Math.sin(i),l=Math.cos(n),c=Math.sin(n),h=Math.cos(r),u=Math.sin(r);if(e.order==="XYZ"){let f=o*h,d=o*u,m=a*h,g=a*u;t[0]=l*h,t[4]=-l*u,t[8]=c,t[1]=d+m*c,t[5]=f-g*c,t[9]=-a*l,t[2]=g-f*c,t[6]=m+d*c,t[10]=o*l}else if(e.order==="YXZ"){let f=l*h,d=l*u,m=c*h,g=c*u;t[0]=f+g*a,t[4]=m*a-d,t[8]=o*c,t[1]=o*u,t[5]=o*h,t[9]=-a,t[2]=d*a-m,t[6]=g+f*a,t[10]=o*l}else if(e.order==="ZXY"){let f=l*h,d=l*u,m=c*h,g=c*u;t[0]=f-g*a,t[4]=-o*u,t[8]=m+d*a,t[1]=d+m*a,t[5]=o*h,t[9]=g-f*a,t[2]=-o*c,t[6]=a,t[10]=o*l}else if(e.order==="ZYX"){let f=o*h,d=o*u,m=a*h,g=a*u;t[0]=l*h,t[4]=m*c-d,t[8]=f*c+g,t[1]=l*u,t[5]=g*c+f,t[9]=d*c-m,t[2]=-c,t[6]=a*l,t[10]=o*l}else if(e.order==="YZX"){let f=o*l,d=o*c,m=a*l,g=a*c;t[0]=l*h,t[4]=g-f*u,t[8]=m*u+d,t[1]=u,t[5]=o*h,t[9]=-a*h,t[2]=-c*h,t[6]=d*u+m,t[10]=f-g*u}else if(e.order==="XZY"){let f=o*l,d=o*c,m=a*l,g=a*c;t[0]=l*h,t[4]=-u,t[8]=c*h,t[1]=f*u+g,t[5]=o*h,t[9]=d*u-m,t[2]=m*u-d,t[6]=a*h,t[10]=g*u+f}return t[3]=0,t[7]=0,t[11]=0,t[12]=0,t[13]=0,t[14]=0,t[15]=1,this}makeRotationFromQuaternion(e){return this.compose(EE,e,CE)}lookAt(e,t,i){let n=this.elements;return ci.subVectors(e,t),ci.lengthSq()===0&&(ci.z=1),ci.normalize(),Yn.crossVectors(i,ci),Yn.lengthSq()===0&&(Math.abs(i.z)===1?ci.x+=1e-4:ci.z+=1e-4,ci.normalize(),Yn.crossVectors(i,ci)),Yn.normalize(),Lc.crossVectors(ci,Yn),n[0]=Yn.x,n[4]=Lc.x,n[8]=ci.x,n[1]=Yn.y,n[5]=Lc.y,n[9]=ci.y,n[2]=Yn.z,n[6]=Lc.z,n[10]=ci.z,this}multiply(e){return this.multiplyMatrices(this,e)}premultiply(e){return this.multiplyMatrices(e,this)}multiplyMatrices(e,t){let i=e.elements,n=t.elements,r=this.elements,o=i[0],a=i[4],l=i[8],c=i[12],h=i[1],u=i[5],f=i[9],d=i[13],m=i[2],g=i[6],y=i[10],_=i[14],w=i[3],A=i[7],T=i[11],C=i[15],E=n[0],P=n[4],O=n[8],H=n[12],G=n[1],k=n[5],D=n[9],F=n[13],V=n[2],N=n[6],ie=n[10],X=n[14],Pe=n[3],ce=n[7],ae=n[11],ue=n[15];return r[0]=o*E+a*G+l*V+c*Pe,r[4]=o*P+a*k+l*N+c*ce,r[8]=o*O+a*D+l*ie+c*ae,r[12]=o*H+a*F+l*X+c*ue,r[1]=h*E+u*G+f*V+d*Pe,r[5]=h*P+u*k+f*N+d*ce,r[9]=h*O+u*D+f*ie+d*ae,r[13]=h*H+u*F+f*X+d*ue,r[2]=m*E+g*G+y*V+_*Pe,r[6]=m*P+g*k+y*N+_*ce,r[10]=m*O+g*D+y*ie+_*ae,r[14]=m*H+g*F+y*X+_*ue,r[3]=w*E+A*G+T*V+C*Pe,r[7]=w*P+A*k+T*N+C*ce,r[11]=w*O+A*D+T*ie+C*ae,r[15]=w*H+A*F+T*X+C*ue,this}multiplyScalar(e){let t=this.elements;return t[0]*=e,t[4]*=e,t[8]*=e,t[12]*=e,t[1]*=e,t[5]*=e,t[9]*=e,t[13]*=e,t[2]*=e,t[6]*=e,t[10]*=e,t[14]*=e,t[3]*=e,t[7]*=e,t[11]*=e,t[15]*=e,this}determinant(){let e=this.elements,t=e[0],i=e[4],n=e[8],r=e[12],o=e[1],a=e[5],l=e[9],c=e[13],h=e[2],u=e[6],f=e[10],d=e[14],m=e[3],g=e[7],y=e[11],_=e[15],w=l*d-c*f,A=a*d-c*u,T=a*f-l*u,C=o*d-c*h,E=o*f-l*h,P=o*u-a*h;return t*(g*w-y*A+_*T)-i*(m*w-y*C+_*E)+n*(m*A-g*C+_*P)-r*(m*T-g*E+y*P)}determinantAffine(){let e=this.elements,t=e[0],i=e[4],n=e[8],r=e[1],o=e[5],a=e[9],l=e[2],c=e[6],h=e[10];return t*(o*h-a*c)-i*(r*h-a*l)+n*(r*c-o*l)}transpose(){let e=this.elements,t;return t=e[1],e[1]=e[4],e[4]=t,t=e[2],e[2]=e[8],e[8]=t,t=e[6],e[6]=e[9],e[9]=t,t=e[3],e[3]=e[12],e[12]=t,t=e[7],e[7]=e[13],e[13]=t,t=e[11],e[11]=e[14],e[14]=t,this}setPosition(e,t,i){let n=this.elements;return e.isVector3?(n[12]=e.x,n[13]=e.y,n[14]=e.z):(n[12]=e,n[13]=t,n[14]=i),this}invert(){let e=this.elements,t=e[0],i=e[1],n=e[2],r=e[3],o=e[4],a=e[5],l=e[6],c=e[7],h=e[8],u=e[9],f=e[10],d=e[11],m=e[12],g=e[13],y=e[14],_=e[15],w=t*a-i*o,A=t*l-n*o,T=t*c-r*o,C=i*l-n*a,E=i*c-r*a,P=n*c-r*l,O=h*g-u*m,H=h*y-f*m,G=h*_-d*m,k=u*y-f*g,D=u*_-d*g,F=f*_-d*y,V=w*F-A*D+T*k+C*G-E*H+P*O;if(V===0)return this.set(0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0);let N=1/V;return e[0]=(a*F-l*D+c*k)*N,e[1]=(n*D-i*F-r*k)*N,e[2]=(g*P-y*E+_*C)*N,e[3]=(f*E-u*P-d*C)*N,e[4]=(l*G-o*F-c*H)*N,e[5]=(t*F-n*G+r*H)*N,e[6]=(y*T-m*P-_*A)*N,e[7]=(h*P-f*T+d*A)*N,e[8]=(o*D-a*G+c*O)*N,e[9]=(i*G-t*D-r*O)*N,e[10]=(m*E-g*T+_*w)*N,e[11]=(u*T-h*E-d*w)*N,e[12]=(a*H-o*k-l*O)*N,e[13]=(t*k-i*H+n*O)*N,e[14]=(g*A-m*C-y*w)*N,e[15]=(h*C-u*A+f*w)*N,this}scale(e){let t=this.elements,i=e.x,n=e.y,r=e.z;return t[0]*=i,t[4]*=n,t[8]*=r,t[1]*=i,t[5]*=n,t[9]*=r,t[2]*=i,t[6]*=n,t[10]*=r,t[3]*=i,t[7]*=n,t[11]*=r,this}getMaxScaleOnAxis(){let e=this.elements,t=e[0]*e[0]+e[1]*e[1]+e[2]*e[2],i=e[4]*e[4]+e[5]*e[5]+e[6]*e[6],n=e[8]*e[8]+e[9]*e[9]+e[10]*e[10];return Math.sqrt(Math.max(t,i,n))}makeTranslation(e,t,i){return e.isVector3?this.set(1,0,0,e.x,0,1,0,e.y,0,0,1,e.z,0,0,0,1):this.set(1,0,0,e,0,1,0,t,0,0,1,i,0,0,0,1),this}makeRotationX(e){let t=Math.cos(e),i=Math.sin(e);return this.set(1,0,0,0,0,t,-i,0,0,i,t,0,0,0,0,1),this}makeRotationY(e){let t=Math.cos(e),i=Math.sin(e);return this.set(t,0,i,0,0,1,0,0,-i,0,t,0,0,0,0,1),this}makeRotationZ(e){let t=Math.cos(e),i=Math.sin(e);return this.set(t,-i,0,0,i,t,0,0,0,0,1,0,0,0,0,1),this}makeRotationAxis(e,t){let i=Math.cos(t),n=Math.sin(t),r=1-i,o=e.x,a=e.y,l=e.z,c=r*o,h=r*a;return this.set(c*o+i,c*a-n*l,c*l+n*a,0,c*a+n*l,h*a+i,h*l-n*o,0,c*l-n*a,h*l+n*o,r*l*l+i,0,0,0,0,1),this}makeScale(e,t,i){return this.set(e,0,0,0,0,t,0,0,0,0,i,0,0,0,0,1),this}makeShear(e,t,i,n,r,o){return this.set(1,i,r,0,e,1,o,0,t,n,1,0,0,0,0,1),this}compose(e,t,i){let n=this.elements,r=t._x,o=t._y,a=t._z,l=t._w,c=r+r,h=o+o,u=a+a,f=r*c,d=r*h,m=r*u,g=o*h,y=o*u,_=a*u,w=l*c,A=l*h,T=l*u,C=i.x,E=i.y,P=i.z;return n[0]=(1-(g+_))*C,n[1]=(d+T)*C,n[2]=(m-A)*C,n[3]=0,n[4]=(d-T)*E,n[5]=(1-(f+_))*E,n[6]=(y+w)*E,n[7]=0,n[8]=(m+A)*P,n[9]=(y-w)*P,n[10]=(1-(f+g))*P,n[11]=0,n[12]=e.x,n[13]=e.y,n[14]=e.z,n[15]=1,this}decompose(e,t,i){let n=this.elements;e.x=n[12],e.y=n[13],e.z=n[14];let r=this.determinantAffine();if(r===0)return i.set(1,1,1),t.identity(),this;let o=$r.set(n[0],n[1],n[2]).length(),a=$r.set(n[4],n[5],n[6]).length(),l=$r.set(n[8],n[9],n[10]).length();r<0&&(o=-o),$i.copy(this);let c=1/o,h=1/a,u=1/l;return $i.elements[0]*=c,$i.elements[1]*=c,$i.elements[2]*=c,$i.elements[4]*=h,$i.elements[5]*=h,$i.elements[6]*=h,$i.elements[8]*=u,$i.elements[9]*=u,$i.elements[10]*=u,t.setFromRotationMatrix($i),i.x=o,i.y=a,i.z=l,this}makePerspective(e,t,i,n,r,o,a=aa,l=!1){let c=this.elements,h=2*r/(t-e),u=2*r/(i-n),f=(t+e)/(t-e),d=(i+n)/(i-n),m,g;if(l)m=r/(o-r),g=o*r/(o-r);else if(a===aa)m=-(o+r)/(o-r),g=-2*o*r/(o-r);else if(a===sp)m=-o/(o-r),g=-o*r/(o-r);else throw new Error("THREE.Matrix4.makePerspective(): Invalid coordinate system: "+a);return c[0]=h,c[4]=0,c[8]=f,c[12]=0,c[1]=0,c[5]=u,c[9]=d,c[13]=0,c[2]=0,c[6]=0,c[10]=m,c[14]=g,c[3]=0,c[7]=0,c[11]=-1,c[15]=0,this}makeOrthographic(e,t,i,n,r,o,a=aa,l=!1){let c=this.elements,h=2/(t-e),u=2/(i-n),f=-(t+e)/(t-e),d=-(i+n)/(i-n),m,g;if(l)m=1/(o-r),g=o/(o-r);else if(a===aa)m=-2/(o-r),g=-(o+r)/(o-r);else if(a===sp)m=-1/(o-r),g=-r/(o-r);else throw new Error("THREE.Matrix4.makeOrthographic(): Invalid coordinate system: "+a);return c[0]=h,c[4]=0,c[8]=0,c[12]=f,c[1]=0,c[5]=u,c[9]=0,c[13]=d,c[2]=0,c[6]=0,c[10]=m,c[14]=g,c[3]=0,c[7]=0,c[11]=0,c[15]=1,this}equals(e){let t=this.elements,i=e.elements;for(let n=0;n<16;n++)if(t[n]!==i[n])return!1;return!0}fromArray(e,t=0){for(let i=0;i<16;i++)this.elements[i]=e[i+t];return this}toArray(e=[],t=0){let i=this.elements;return e[t]=i[0],e[t+1]=i[1],e[t+2]=i[2],e[t+3]=i[3],e[t+4]=i[4],e[t+5]=i[5],e[t+6]=i[6],e[t+7]=i[7],e[t+8]=i[8],e[t+9]=i[9],e[t+10]=i[10],e[t+11]=i[11],e[t+12]=i[12],e[t+13]=i[13],e[t+14]=i[14],e[t+15]=i[15],e}},$r=new it,$i=new An,EE=new it(0,0,0),CE=new it(1,1,1),Yn=new it,Lc=new it,ci=new it,ib=new An,nb=new Tn,Os=class s{constructor(e=0,t=0,i=0,n=s.DEFAULT_ORDER){this.isEuler=!0,this._x=e,this._y=t,this._z=i,this._order=n}get x(){return this._x}set x(e){this._x=e,this._onChangeCallback()}get y(){return this._y}set y(e){this._y=e,this._onChangeCallback()}get z(){return this._z}set z(e){this._z=e,this._onChangeCallback()}get order(){return this._order}set order(e){this._order=e,this._onChangeCallback()}set(e,t,i,n=this._order){return this._x=e,this._y=t,this._z=i,this._order=n,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._order)}copy(e){return this._x=e._x,this._y=e._y,this._z=e._z,this._order=e._order,this._onChangeCallback(),this}setFromRotationMatrix(e,t=this._order,i=!0){let n=e.elements,r=n[0],o=n[4],a=n[8],l=n[1],c=n[5],h=n[9],u=n[2],f=n[6],d=n[10];switch(t){case"XYZ":this._y=Math.asin(_e(a,-1,1)),Math.abs(a)<.9999999?(this._x=Math.atan2(-h,d),this._z=Math.atan2(-o,r)):(this._x=Math.atan2(f,c),this._z=0);break;case"YXZ":this._x=Math.asin(-_e(h,-1,1)),Math.abs(h)<.9999999?(this._y=Math.atan2(a,d),this._z=Math.atan2(l,c)):(this._y=Math.atan2(-u,r),this._z=0);break;case"ZXY":this._x=Math.asin(_e(f,-1,1)),Math.abs(f)<.9999999?(this._y=Math.atan2(-u,d),this._z=Math.atan2(-o,c)):(this._y=0,this._z=Math.atan2(l,r));break;case"ZYX":this._y=Math.asin(-_e(u,-1,1)),Math.abs(u)<.9999999?(this._x=Math.atan2(f,d),this._z=Math.atan2(l,r)):(this._x=0,this._z=Math.atan2(-o,c));break;case"YZX":this._z=Math.asin(_e(l,-1,1)),Math.abs(l)<.9999999?(this._x=Math.atan2(-h,c),this._y=Math.atan2(-u,r)):(this._x=0,this._y=Math.atan2(a,d));break;case"XZY":this._z=Math.asin(-_e(o,-1,1)),Math.abs(o)<.9999999?(this._x=Math.atan2(f,c),this._y=Math.atan2(a,r)):(this._x=Math.atan2(-h,d),this._y=0);break;default:It("Euler: .setFromRotationMatrix() encountered an unknown order: "+t)}return this._order=t,i===!0&&this._onChangeCallback(),this}setFromQuaternion(e,t,i){return ib.makeRotationFromQuaternion(e),this.setFromRotationMatrix(ib,t,i)}setFromVector3(e,t=this._order){return this.set(e.x,e.y,e.z,t)}reorder(e){return nb.setFromEuler(this),this.setFromQuaternion(nb,e)}equals(e){return e._x===this._x&&e._y===this._y&&e._z===this._z&&e._order===this._order}fromArray(e){return this._x=e[0],this._y=e[1],this._z=e[2],e[3]!==void 0&&(this._order=e[3]),this._onChangeCallback(),this}toArray(e=[],t=0){return e[t]=this._x,e[t+1]=this._y,e[t+2]=this._z,e[t+3]=this._order,e}_onChange(e){return this._onChangeCallback=e,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._order}};Os.DEFAULT_ORDER="XYZ";var Gc=class{constructor(){this.mask=1}set(e){this.mask=(1<<e|0)>>>0}enable(e){this.mask|=1<<e|0}enableAll(){this.mask=-1}toggle(e){this.mask^=1<<e|0}disable(e){this.mask&=~(1<<e|0)}disableAll(){this.mask=0}test(e){return(this.mask&e.mask)!==0}isEnabled(e){return(this.mask&(1<<e|0))!==0}},RE=0,sb=new it,Yr=new Tn,wn=new An,Ic=new it,ra=new it,PE=new it,kE=new Tn,rb=new it(1,0,0),ob=new it(0,1,0),ab=new it(0,0,1),lb={type:"added"},LE={type:"removed"},Kr={type:"childadded",child:null},zd={type:"childremoved",child:null},Fs=class s extends ca{constructor(){super(),this.isObject3D=!0,Object.defineProperty(this,"id",{value:RE++}),this.uuid=vp(),this.name="",this.type="Object3D",this.parent=null,this.children=[],this.up=s.DEFAULT_UP.clone();let e=new it,t=new Os,i=new Tn,n=new it(1,1,1);function r(){i.setFromEuler(t,!1)}function o(){t.setFromQuaternion(i,void 0,!1)}t._onChange(r),i._onChange(o),Object.defineProperties(this,{position:{configurable:!0,enumerable:!0,value:e},rotation:{configurable:!0,enumerable:!0,value:t},quaternion:{configurable:!0,enumerable:!0,value:i},scale:{configurable:!0,enumerable:!0,value:n},modelViewMatrix:{value:new An},normalMatrix:{value:new pe}}),this.matrix=new An,this.matrixWorld=new An,this.matrixAutoUpdate=s.DEFAULT_MATRIX_AUTO_UPDATE,this.matrixWorldAutoUpdate=s.DEFAULT_MATRIX_WORLD_AUTO_UPDATE,this.matrixWorldNeedsUpdate=!1,this.layers=new Gc,this.visible=!0,this.castShadow=!1,this.receiveShadow=!1,this.frustumCulled=!0,this.renderOrder=0,this.animations=[],this.customDepthMaterial=void 0,this.customDistanceMaterial=void 0,this.static=!1,this.userData={},this.pivot=null}onBeforeShadow(){}onAfterShadow(){}onBeforeRender(){}onAfterRender(){}applyMatrix4(e){this.matrixAutoUpdate&&this.updateMatrix(),this.matrix.premultiply(e),this.matrix.decompose(this.position,this.quaternion,this.scale),this.pivot!==null&&this.position.copy(this.pivot).applyMatrix4(this.matrix).sub(this.pivot)}applyQuaternion(e){return this.quaternion.premultiply(e),this}setRotationFromAxisAngle(e,t){this.quaternion.setFromAxisAngle(e,t)}setRotationFromEuler(e){this.quaternion.setFromEuler(e,!0)}setRotationFromMatrix(e){this.quaternion.setFromRotationMatrix(e)}setRotationFromQuaternion(e){this.quaternion.copy(e)}rotateOnAxis(e,t){return Yr.setFromAxisAngle(e,t),this.quaternion.multiply(Yr),this}rotateOnWorldAxis(e,t){return Yr.setFromAxisAngle(e,t),this.quaternion.premultiply(Yr),this}rotateX(e){return this.rotateOnAxis(rb,e)}rotateY(e){return this.rotateOnAxis(ob,e)}rotateZ(e){return this.rotateOnAxis(ab,e)}translateOnAxis(e,t){return sb.copy(e).applyQuaternion(this.quaternion),this.position.add(sb.multiplyScalar(t)),this}translateX(e){return this.translateOnAxis(rb,e)}translateY(e){return this.translateOnAxis(ob,e)}translateZ(e){return this.translateOnAxis(ab,e)}localToWorld(e){return this.updateWorldMatrix(!0,!1),e.applyMatrix4(this.matrixWorld)}worldToLocal(e){return this.updateWorldMatrix(!0,!1),e.applyMatrix4(wn.copy(this.matrixWorld).invert())}lookAt(e,t,i){e.isVector3?Ic.copy(e):Ic.set(e,t,i);let n=this.parent;this.updateWorldMatrix(!0,!1),ra.setFromMatrixPosition(this.matrixWorld),this.isCamera||this.isLight?wn.lookAt(ra,Ic,this.up):wn.lookAt(Ic,ra,this.up),this.quaternion.setFromRotationMatrix(wn),n&&(wn.extractRotation(n.matrixWorld),Yr.setFromRotationMatrix(wn),this.quaternion.premultiply(Yr.invert()))}add(e){if(arguments.length>1){for(let t=0;t<arguments.length;t++)this.add(arguments[t]);return this}return e===this?(St("Object3D.add: object can't be added as a child of itself.",e),this):(e&&e.isObject3D?(e.removeFromParent(),e.parent=this,this.children.push(e),e.dispatchEvent(lb),Kr.child=e,this.dispatchEvent(Kr),Kr.child=null):St("Object3D.add: object not an instance of THREE.Object3D.",e),this)}remove(e){if(arguments.length>1){for(let i=0;i<arguments.length;i++)this.remove(arguments[i]);return this}let t=this.children.indexOf(e);return t!==-1&&(e.parent=null,this.children.splice(t,1),e.dispatchEvent(LE),zd.child=e,this.dispatchEvent(zd),zd.child=null),this}removeFromParent(){let e=this.parent;return e!==null&&e.remove(this),this}clear(){return this.remove(...this.children)}attach(e){return this.updateWorldMatrix(!0,!1),wn.copy(this.matrixWorld).invert(),e.parent!==null&&(e.parent.updateWorldMatrix(!0,!1),wn.multiply(e.parent.matrixWorld)),e.applyMatrix4(wn),e.removeFromParent(),e.parent=this,this.children.push(e),e.updateWorldMatrix(!1,!0),e.dispatchEvent(lb),Kr.child=e,this.dispatchEvent(Kr),Kr.child=null,this}getObjectById(e){return this.getObjectByProperty("id",e)}getObjectByName(e){return this.getObjectByProperty("name",e)}getObjectByProperty(e,t){if(this[e]===t)return this;for(let i=0,n=this.children.length;i<n;i++){let o=this.children[i].getObjectByProperty(e,t);if(o!==void 0)return o}}getObjectsByProperty(e,t,i=[]){this[e]===t&&i.push(this);let n=this.children;for(let r=0,o=n.length;r<o;r++)n[r].getObjectsByProperty(e,t,i);return i}getWorldPosition(e){return this.updateWorldMatrix(!0,!1),e.setFromMatrixPosition(this.matrixWorld)}getWorldQuaternion(e){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(ra,e,PE),e}getWorldScale(e){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(ra,kE,e),e}getWorldDirection(e){this.updateWorldMatrix(!0,!1);let t=this.matrixWorld.elements;return e.set(t[8],t[9],t[10]).normalize()}raycast(){}intersectsFrustum(){return!0}traverse(e){e(this);let t=this.children;for(let i=0,n=t.length;i<n;i++)t[i].traverse(e)}traverseVisible(e){if(this.visible===!1)return;e(this);let t=this.children;for(let i=0,n=t.length;i<n;i++)t[i].traverseVisible(e)}traverseAncestors(e){let t=this.parent;t!==null&&(e(t),t.traverseAncestors(e))}updateMatrix(){this.matrix.compose(this.position,this.quaternion,this.scale);let e=this.pivot;if(e!==null){let t=e.x,i=e.y,n=e.z,r=this.matrix.elements;r[12]+=t-r[0]*t-r[4]*i-r[8]*n,r[13]+=i-r[1]*t-r[5]*i-r[9]*n,r[14]+=n-r[2]*t-r[6]*i-r[10]*n}this.matrixWorldNeedsUpdate=!0}updateMatrixWorld(e){this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||e)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,e=!0);let t=this.children;for(let i=0,n=t.length;i<n;i++)t[i].updateMatrixWorld(e)}updateWorldMatrix(e,t,i=!1){let n=this.parent;if(e===!0&&n!==null&&n.updateWorldMatrix(!0,!1),this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||i)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,i=!0),t===!0){let r=this.children;for(let o=0,a=r.length;o<a;o++)r[o].updateWorldMatrix(!1,!0,i)}}toJSON(e){let t=e===void 0||typeof e=="string",i={};t&&(e={geometries:{},materials:{},textures:{},images:{},shapes:{},skeletons:{},animations:{},nodes:{}},i.metadata={version:4.7,type:"Object",generator:"Object3D.toJSON"});let n={};n.uuid=this.uuid,n.type=this.type,n.name=this.name,n.castShadow=this.castShadow,n.receiveShadow=this.receiveShadow,n.visible=this.visible,n.frustumCulled=this.frustumCulled,n.renderOrder=this.renderOrder,n.static=this.static,n.matrixAutoUpdate=this.matrixAutoUpdate,Object.keys(this.userData).length>0&&(n.userData=this.userData),n.layers=this.layers.mask,n.matrix=this.matrix.toArray(),n.up=this.up.toArray(),this.pivot!==null&&(n.pivot=this.pivot.toArray()),this.morphTargetDictionary!==void 0&&(n.morphTargetDictionary=Object.assign({},this.morphTargetDictionary)),this.morphTargetInfluences!==void 0&&(n.morphTargetInfluences=this.morphTargetInfluences.slice()),this.isInstancedMesh&&(n.type="InstancedMesh",n.count=this.count,n.instanceMatrix=this.instanceMatrix.toJSON(),this.instanceColor!==null&&(n.instanceColor=this.instanceColor.toJSON())),this.isBatchedMesh&&(n.type="BatchedMesh",n.perObjectFrustumCulled=this.perObjectFrustumCulled,n.sortObjects=this.sortObjects,n.drawRanges=this._drawRanges,n.reservedRanges=this._reservedRanges,n.geometryInfo=this._geometryInfo.map(a=>({...a,boundingBox:a.boundingBox?a.boundingBox.toJSON():void 0,boundingSphere:a.boundingSphere?a.boundingSphere.toJSON():void 0})),n.instanceInfo=this._instanceInfo.map(a=>({...a})),n.availableInstanceIds=this._availableInstanceIds.slice(),n.availableGeometryIds=this._availableGeometryIds.slice(),n.nextIndexStart=this._nextIndexStart,n.nextVertexStart=this._nextVertexStart,n.geometryCount=this._geometryCount,n.maxInstanceCount=this._maxInstanceCount,n.maxVertexCount=this._maxVertexCount,n.maxIndexCount=this._maxIndexCount,n.geometryInitialized=this._geometryInitialized,n.matricesTexture=this._matricesTexture.toJSON(e),n.indirectTexture=this._indirectTexture.toJSON(e),this._colorsTexture!==null&&(n.colorsTexture=this._colorsTexture.toJSON(e)),this.boundingSphere!==null&&(n.boundingSphere=this.boundingSphere.toJSON()),this.boundingBox!==null&&(n.boundingBox=this.boundingBox.toJSON()));function r(a,l){return a[l.uuid]===void 0&&(a[l.uuid]=l.toJSON(e)),l.uuid}if(this.isScene)this.background&&(this.background.isColor?n.background=this.background.toJSON():this.background.isTexture&&(n.background=this.background.toJSON(e).uuid)),this.environment&&this.environment.isTexture&&this.environment.isRenderTargetTexture!==!0&&(n.environment=this.environment.toJSON(e).uuid);else if(this.isMesh||this.isLine||this.isPoints){n.geometry=r(e.geometries,this.geometry);let a=this.geometry.parameters;if(a!==void 0&&a.shapes!==void 0){let l=a.shapes;if(Array.isArray(l))for(let c=0,h=l.length;c<h;c++){let u=l[c];r(e.shapes,u)}else r(e.shapes,l)}}if(this.isSkinnedMesh&&(n.bindMode=this.bindMode,n.bindMatrix=this.bindMatrix.toArray(),this.skeleton!==void 0&&(r(e.skeletons,this.skeleton),n.skeleton=this.skeleton.uuid)),this.material!==void 0)if(Array.isArray(this.material)){let a=[];for(let l=0,c=this.material.length;l<c;l++)a.push(r(e.materials,this.material[l]));n.material=a}else n.material=r(e.materials,this.material);if(this.children.length>0){n.children=[];for(let a=0;a<this.children.length;a++)n.children.push(this.children[a].toJSON(e).object)}if(this.animations.length>0){n.animations=[];for(let a=0;a<this.animations.length;a++){let l=this.animations[a];n.animations.push(r(e.animations,l))}}if(t){let a=o(e.geometries),l=o(e.materials),c=o(e.textures),h=o(e.images),u=o(e.shapes),f=o(e.skeletons),d=o(e.animations),m=o(e.nodes);a.length>0&&(i.geometries=a),l.length>0&&(i.materials=l),c.length>0&&(i.textures=c),h.length>0&&(i.images=h),u.length>0&&(i.shapes=u),f.length>0&&(i.skeletons=f),d.length>0&&(i.animations=d),m.length>0&&(i.nodes=m)}return i.object=n,i;function o(a){let l=[];for(let c in a){let h=a[c];delete h.metadata,l.push(h)}return l}}clone(e){return new this.constructor().copy(this,e)}copy(e,t=!0){if(this.name=e.name,this.up.copy(e.up),this.position.copy(e.position),this.rotation.order=e.rotation.order,this.quaternion.copy(e.quaternion),this.scale.copy(e.scale),this.pivot=e.pivot!==null?e.pivot.clone():null,this.matrix.copy(e.matrix),this.matrixWorld.copy(e.matrixWorld),this.matrixAutoUpdate=e.matrixAutoUpdate,this.matrixWorldAutoUpdate=e.matrixWorldAutoUpdate,this.matrixWorldNeedsUpdate=e.matrixWorldNeedsUpdate,this.layers.mask=e.layers.mask,this.visible=e.visible,this.castShadow=e.castShadow,this.receiveShadow=e.receiveShadow,this.frustumCulled=e.frustumCulled,this.renderOrder=e.renderOrder,this.static=e.static,this.animations=e.animations.slice(),this.userData=JSON.parse(JSON.stringify(e.userData)),t===!0)for(let i=0;i<e.children.length;i++){let n=e.children[i];this.add(n.clone())}return this}dispose(){this.dispatchEvent({type:"dispose"})}};Fs.DEFAULT_UP=new it(0,1,0);Fs.DEFAULT_MATRIX_AUTO_UPDATE=!0;Fs.DEFAULT_MATRIX_WORLD_AUTO_UPDATE=!0;var wb={aliceblue:15792383,antiquewhite:16444375,aqua:65535,aquamarine:8388564,azure:15794175,beige:16119260,bisque:16770244,black:0,blanchedalmond:16772045,blue:255,blueviolet:9055202,brown:10824234,burlywood:14596231,cadetblue:6266528,chartreuse:8388352,chocolate:13789470,coral:16744272,cornflowerblue:6591981,cornsilk:16775388,crimson:14423100,cyan:65535,darkblue:139,darkcyan:35723,darkgoldenrod:12092939,darkgray:11119017,darkgreen:25600,darkgrey:11119017,darkkhaki:12433259,darkmagenta:9109643,darkolivegreen:5597999,darkorange:16747520,darkorchid:10040012,darkred:9109504,darksalmon:15308410,darkseagreen:9419919,darkslateblue:4734347,darkslategray:3100495,darkslategrey:3100495,darkturquoise:52945,darkviolet:9699539,deeppink:16716947,deepskyblue:49151,dimgray:6908265,dimgrey:6908265,dodgerblue:2003199,firebrick:11674146,floralwhite:16775920,forestgreen:2263842,fuchsia:16711935,gainsboro:14474460,ghostwhite:16316671,gold:16766720,goldenrod:14329120,gray:8421504,green:32768,greenyellow:11403055,grey:8421504,honeydew:15794160,hotpink:16738740,indianred:13458524,indigo:4915330,ivory:16777200,khaki:15787660,lavender:15132410,lavenderblush:16773365,lawngreen:8190976,lemonchiffon:16775885,lightblue:11393254,lightcoral:15761536,lightcyan:14745599,lightgoldenrodyellow:16448210,lightgray:13882323,lightgreen:9498256,lightgrey:13882323,lightpink:16758465,lightsalmon:16752762,lightseagreen:2142890,lightskyblue:8900346,lightslategray:7833753,lightslategrey:7833753,lightsteelblue:11584734,lightyellow:16777184,lime:65280,limegreen:3329330,linen:16445670,magenta:16711935,maroon:8388608,mediumaquamarine:6737322,mediumblue:205,mediumorchid:12211667,mediumpurple:9662683,mediumseagreen:3978097,mediumslateblue:8087790,mediumspringgreen:64154,mediumturquoise:4772300,mediumvioletred:13047173,midnightblue:1644912,mintcream:16121850,mistyrose:16770273,moccasin:16770229,navajowhite:16768685,navy:128,oldlace:16643558,olive:8421376,olivedrab:7048739,orange:16753920,orangered:16729344,orchid:14315734,palegoldenrod:15657130,palegreen:10025880,paleturquoise:11529966,palevioletred:14381203,papayawhip:16773077,peachpuff:16767673,peru:13468991,pink:16761035,plum:14524637,powderblue:11591910,purple:8388736,rebeccapurple:6697881,red:16711680,rosybrown:12357519,royalblue:4286945,saddlebrown:9127187,salmon:16416882,sandybrown:16032864,seagreen:3050327,seashell:16774638,sienna:10506797,silver:12632256,skyblue:8900331,slateblue:6970061,slategray:7372944,slategrey:7372944,snow:16775930,springgreen:65407,steelblue:4620980,tan:13808780,teal:32896,thistle:14204888,tomato:16737095,turquoise:4251856,violet:15631086,wheat:16113331,white:16777215,whitesmoke:16119285,yellow:16776960,yellowgreen:10145074},Kn={h:0,s:0,l:0},Dc={h:0,s:0,l:0};function Vd(s,e,t){return t<0&&(t+=1),t>1&&(t-=1),t<1/6?s+(e-s)*6*t:t<1/2?e:t<2/3?s+(e-s)*6*(2/3-t):s}var wt=class{constructor(e,t,i){return this.isColor=!0,this.r=1,this.g=1,this.b=1,this.set(e,t,i)}set(e,t,i){if(t===void 0&&i===void 0){let n=e;n&&n.isColor?this.copy(n):typeof n=="number"?this.setHex(n):typeof n=="string"&&this.setStyle(n)}else this.setRGB(e,t,i);return this}setScalar(e){return this.r=e,this.g=e,this.b=e,this}setHex(e,t=Ri){return e=Math.floor(e),this.r=(e>>16&255)/255,this.g=(e>>8&255)/255,this.b=(e&255)/255,Ci.colorSpaceToWorking(this,t),this}setRGB(e,t,i,n=Ci.workingColorSpace){return this.r=e,this.g=t,this.b=i,Ci.colorSpaceToWorking(this,n),this}setHSL(e,t,i,n=Ci.workingColorSpace){if(e=wE(e,1),t=_e(t,0,1),i=_e(i,0,1),t===0)this.r=this.g=this.b=i;else{let r=i<=.5?i*(1+t):i+t-i*t,o=2*i-r;this.r=Vd(o,r,e+1/3),this.g=Vd(o,r,e),this.b=Vd(o,r,e-1/3)}return Ci.colorSpaceToWorking(this,n),this}setStyle(e,t=Ri){function i(r){r!==void 0&&parseFloat(r)<1&&It("Color: Alpha component of "+e+" will be ignored.")}let n;if(n=/^(\w+)\(([^\)]*)\)/.exec(e)){let r,o=n[1],a=n[2];switch(o){case"rgb":case"rgba":if(r=/^\s*(\d+)\s*,\s*(\d+)\s*,\s*(\d+)\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return i(r[4]),this.setRGB(Math.min(255,parseInt(r[1],10))/255,Math.min(255,parseInt(r[2],10))/255,Math.min(255,parseInt(r[3],10))/255,t);if(r=/^\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return i(r[4]),this.setRGB(Math.min(100,parseFloat(r[1]))/100,Math.min(100,parseFloat(r[2]))/100,Math.min(100,parseFloat(r[3]))/100,t);break;case"hsl":case"hsla":if(r=/^\s*([+-]?(?:\d+(?:\.\d+)?|\.\d+))\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return i(r[4]),this.setHSL(parseFloat(r[1])/360,parseFloat(r[2])/100,parseFloat(r[3])/100,t);break;default:It("Color: Unknown color model "+e)}}else if(n=/^\#([A-Fa-f\d]+)$/.exec(e)){let r=n[1],o=r.length;if(o===3)return this.setRGB(parseInt(r.charAt(0),16)/15,parseInt(r.charAt(1),16)/15,parseInt(r.charAt(2),16)/15,t);if(o===6)return this.setHex(parseInt(r,16),t);It("Color: Invalid hex color "+e)}else if(e&&e.length>0)return this.setColorName(e,t);return this}setColorName(e,t=Ri){let i=wb[e.toLowerCase()];return i!==void 0?this.setHex(i,t):It("Color: Unknown color "+e),this}clone(){return new this.constructor(this.r,this.g,this.b)}copy(e){return this.r=e.r,this.g=e.g,this.b=e.b,this}copySRGBToLinear(e){return this.r=Mn(e.r),this.g=Mn(e.g),this.b=Mn(e.b),this}copyLinearToSRGB(e){return this.r=Zr(e.r),this.g=Zr(e.g),this.b=Zr(e.b),this}convertSRGBToLinear(){return this.copySRGBToLinear(this),this}convertLinearToSRGB(){return this.copyLinearToSRGB(this),this}getHex(e=Ri){return Ci.workingToColorSpace(Lt.copy(this),e),Math.round(_e(Lt.r*255,0,255))*65536+Math.round(_e(Lt.g*255,0,255))*256+Math.round(_e(Lt.b*255,0,255))}getHexString(e=Ri){return("000000"+this.getHex(e).toString(16)).slice(-6)}getHSL(e,t=Ci.workingColorSpace){Ci.workingToColorSpace(Lt.copy(this),t);let i=Lt.r,n=Lt.g,r=Lt.b,o=Math.max(i,n,r),a=Math.min(i,n,r),l,c,h=(a+o)/2;if(a===o)l=0,c=0;else{let u=o-a;switch(c=h<=.5?u/(o+a):u/(2-o-a),o){case i:l=(n-r)/u+(n<r?6:0);break;case n:l=(r-i)/u+2;break;case r:l=(i-n)/u+4;break}l/=6}return e.h=l,e.s=c,e.l=h,e}getRGB(e,t=Ci.workingColorSpace){return Ci.workingToColorSpace(Lt.copy(this),t),e.r=Lt.r,e.g=Lt.g,e.b=Lt.b,e}getStyle(e=Ri){Ci.workingToColorSpace(Lt.copy(this),e);let t=Lt.r,i=Lt.g,n=Lt.b;return e!==Ri?`color(${e} ${t.toFixed(3)} ${i.toFixed(3)} ${n.toFixed(3)})`:`rgb(${Math.round(t*255)},${Math.round(i*255)},${Math.round(n*255)})`}offsetHSL(e,t,i){return this.getHSL(Kn),this.setHSL(Kn.h+e,Kn.s+t,Kn.l+i)}add(e){return this.r+=e.r,this.g+=e.g,this.b+=e.b,this}addColors(e,t){return this.r=e.r+t.r,this.g=e.g+t.g,this.b=e.b+t.b,this}addScalar(e){return this.r+=e,this.g+=e,this.b+=e,this}sub(e){return this.r=Math.max(0,this.r-e.r),this.g=Math.max(0,this.g-e.g),this.b=Math.max(0,this.b-e.b),this}multiply(e){return this.r*=e.r,this.g*=e.g,this.b*=e.b,this}multiplyScalar(e){return this.r*=e,this.g*=e,this.b*=e,this}lerp(e,t){return this.r+=(e.r-this.r)*t,this.g+=(e.g-this.g)*t,this.b+=(e.b-this.b)*t,this}lerpColors(e,t,i){return this.r=e.r+(t.r-e.r)*i,this.g=e.g+(t.g-e.g)*i,this.b=e.b+(t.b-e.b)*i,this}lerpHSL(e,t){this.getHSL(Kn),e.getHSL(Dc);let i=Nd(Kn.h,Dc.h,t),n=Nd(Kn.s,Dc.s,t),r=Nd(Kn.l,Dc.l,t);return this.setHSL(i,n,r),this}setFromVector3(e){return this.r=e.x,this.g=e.y,this.b=e.z,this}applyMatrix3(e){let t=this.r,i=this.g,n=this.b,r=e.elements;return this.r=r[0]*t+r[3]*i+r[6]*n,this.g=r[1]*t+r[4]*i+r[7]*n,this.b=r[2]*t+r[5]*i+r[8]*n,this}equals(e){return e.r===this.r&&e.g===this.g&&e.b===this.b}fromArray(e,t=0){return this.r=e[t],this.g=e[t+1],this.b=e[t+2],this}toArray(e=[],t=0){return e[t]=this.r,e[t+1]=this.g,e[t+2]=this.b,e}fromBufferAttribute(e,t){return this.r=e.getX(t),this.g=e.getY(t),this.b=e.getZ(t),this}toJSON(){return this.getHex()}*[Symbol.iterator](){yield this.r,yield this.g,yield this.b}},Lt=new wt;wt.NAMES=wb;var ha=class extends Fs{constructor(){super(),this.isScene=!0,this.type="Scene",this.background=null,this.environment=null,this.fog=null,this.backgroundBlurriness=0,this.backgroundIntensity=1,this.backgroundRotation=new Os,this.environmentIntensity=1,this.environmentRotation=new Os,this.overrideMaterial=null,typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}copy(e,t){return super.copy(e,t),this.background=e.background!==null?e.background.clone():null,this.environment=e.environment!==null?e.environment.clone():null,this.fog=e.fog!==null?e.fog.clone():null,this.backgroundBlurriness=e.backgroundBlurriness,this.backgroundIntensity=e.backgroundIntensity,this.backgroundRotation.copy(e.backgroundRotation),this.environmentIntensity=e.environmentIntensity,this.environmentRotation.copy(e.environmentRotation),this.overrideMaterial=e.overrideMaterial!==null?e.overrideMaterial.clone():null,this.matrixAutoUpdate=e.matrixAutoUpdate,this}toJSON(e){let t=super.toJSON(e);return this.fog!==null&&(t.object.fog=this.fog.toJSON()),t.object.backgroundBlurriness=this.backgroundBlurriness,t.object.backgroundIntensity=this.backgroundIntensity,t.object.backgroundRotation=this.backgroundRotation.toArray(),t.object.environmentIntensity=this.environmentIntensity,t.object.environmentRotation=this.environmentRotation.toArray(),t}};function Mb(s){let e={};for(let t in s){e[t]={};for(let i in s[t]){let n=s[t][i];if(cb(n))n.isRenderTargetTexture?(It("UniformsUtils: Textures of render targets cannot be cloned via cloneUniforms() or mergeUniforms()."),e[t][i]=null):e[t][i]=n.clone();else if(Array.isArray(n))if(cb(n[0])){let r=[];for(let o=0,a=n.length;o<a;o++)r[o]=n[o].clone();e[t][i]=r}else e[t][i]=n.slice();else e[t][i]=n}}return e}function Wt(s){let e={};for(let t=0;t<s.length;t++){let i=Mb(s[t]);for(let n in i)e[n]=i[n]}return e}function cb(s){return s&&(s.isColor||s.isMatrix3||s.isMatrix4||s.isVector2||s.isVector3||s.isVector4||s.isTexture||s.isQuaternion)}function Jr(s,e){return!s||s.constructor===e?s:typeof e.BYTES_PER_ELEMENT=="number"?new e(s):Array.prototype.slice.call(s)}function Nc(s){return s!==void 0&&s.inTangents!==void 0&&s.outTangents!==void 0}var Jn=class{constructor(e,t,i,n){this.parameterPositions=e,this._cachedIndex=0,this.resultBuffer=n!==void 0?n:new t.constructor(i),this.sampleValues=t,this.valueSize=i,this.settings=null,this.DefaultSettings_={}}evaluate(e){let t=this.parameterPositions,i=this._cachedIndex,n=t[i],r=t[i-1];e:{t:{let o;i:{n:if(!(e<n)){for(let a=i+2;;){if(n===void 0){if(e<r)break n;return i=t.length,this._cachedIndex=i,this.copySampleValue_(i-1)}if(i===a)break;if(r=n,n=t[++i],e<n)break t}o=t.length;break i}if(!(e>=r)){let a=t[1];e<a&&(i=2,r=a);for(let l=i-2;;){if(r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(i===l)break;if(n=r,r=t[--i-1],e>=r)break t}o=i,i=0;break i}break e}for(;i<o;){let a=i+o>>>1;e<t[a]?o=a:i=a+1}if(n=t[i],r=t[i-1],r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(n===void 0)return i=t.length,this._cachedIndex=i,this.copySampleValue_(i-1)}this._cachedIndex=i,this.intervalChanged_(i,r,n)}return this.interpolate_(i,r,e,n)}getSettings_(){return this.settings||this.DefaultSettings_}copySampleValue_(e){let t=this.resultBuffer,i=this.sampleValues,n=this.valueSize,r=e*n;for(let o=0;o!==n;++o)t[o]=i[r+o];return t}interpolate_(){throw new Error("THREE.Interpolant: Call to abstract method.")}intervalChanged_(){}},Wc=class extends Jn{constructor(e,t,i,n){super(e,t,i,n),this._weightPrev=-0,this._offsetPrev=-0,this._weightNext=-0,this._offsetNext=-0,this.DefaultSettings_={endingStart:Qd,endingEnd:Qd}}intervalChanged_(e,t,i){let n=this.parameterPositions,r=e-2,o=e+1,a=n[r],l=n[o];if(a===void 0)switch(this.getSettings_().endingStart){case ep:r=e,a=2*t-i;break;case tp:r=n.length-2,a=t+n[r]-n[r+1];break;default:r=e,a=i}if(l===void 0)switch(this.getSettings_().endingEnd){case ep:o=e,l=2*i-t;break;case tp:o=1,l=i+n[1]-n[0];break;default:o=e-1,l=t}let c=(i-t)*.5,h=this.valueSize;this._weightPrev=c/(t-a),this._weightNext=c/(l-i),this._offsetPrev=r*h,this._offsetNext=o*h}interpolate_(e,t,i,n){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=e*a,c=l-a,h=this._offsetPrev,u=this._offsetNext,f=this._weightPrev,d=this._weightNext,m=(i-t)/(n-t),g=m*m,y=g*m,_=-f*y+2*f*g-f*m,w=(1+f)*y+(-1.5-2*f)*g+(-.5+f)*m+1,A=(-1-d)*y+(1.5+d)*g+.5*m,T=d*y-d*g;for(let C=0;C!==a;++C)r[C]=_*o[h+C]+w*o[c+C]+A*o[l+C]+T*o[u+C];return r}},qc=class extends Jn{constructor(e,t,i,n){super(e,t,i,n)}interpolate_(e,t,i,n){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=e*a,c=l-a,h=(i-t)/(n-t),u=1-h;for(let f=0;f!==a;++f)r[f]=o[c+f]*u+o[l+f]*h;return r}},Xc=class extends Jn{constructor(e,t,i,n){super(e,t,i,n)}interpolate_(e){return this.copySampleValue_(e-1)}},$c=class extends Jn{interpolate_(e,t,i,n){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=e*a,c=l-a,h=this.inTangents,u=this.outTangents;if(!h||!u){let m=(i-t)/(n-t),g=1-m;for(let y=0;y!==a;++y)r[y]=o[c+y]*g+o[l+y]*m;return r}let f=a*2,d=e-1;for(let m=0;m!==a;++m){let g=o[c+m],y=o[l+m],_=d*f+m*2,w=u[_],A=u[_+1],T=e*f+m*2,C=h[T],E=h[T+1],P=DE(i,t,w,C,n);r[m]=Ab(P,g,A,E,y)}return r}};function Ab(s,e,t,i,n){let r=1-s;return r*r*r*e+3*r*r*s*t+3*r*s*s*i+s*s*s*n}function IE(s,e,t,i,n){let r=1-s;return 3*r*r*(t-e)+6*r*s*(i-t)+3*s*s*(n-i)}function DE(s,e,t,i,n){let r=(s-e)/(n-e);for(let o=0;o<8;o++){let a=Ab(r,e,t,i,n)-s;if(Math.abs(a)<1e-10)break;let l=IE(r,e,t,i,n);if(Math.abs(l)<1e-10)break;r=Math.max(0,Math.min(1,r-a/l))}return r}var hi=class{constructor(e,t,i,n){if(e===void 0)throw new Error("THREE.KeyframeTrack: track name is undefined");if(t===void 0||t.length===0)throw new Error("THREE.KeyframeTrack: no keyframes in track named "+e);this.name=e,this.times=Jr(t,this.TimeBufferType),this.values=Jr(i,this.ValueBufferType),this.setInterpolation(n||this.DefaultInterpolation)}static toJSON(e){let t=e.constructor,i;if(t.toJSON!==this.toJSON)i=t.toJSON(e);else{i={name:e.name,times:Jr(e.times,Array),values:Jr(e.values,Array)};let n=e.getInterpolation();n!==e.DefaultInterpolation&&(i.interpolation=n),Nc(e.settings)&&(i.settings={inTangents:Jr(e.settings.inTangents,Array),outTangents:Jr(e.settings.outTangents,Array)})}return i.type=e.ValueTypeName,i}InterpolantFactoryMethodDiscrete(e){return new Xc(this.times,this.values,this.getValueSize(),e)}InterpolantFactoryMethodLinear(e){return new qc(this.times,this.values,this.getValueSize(),e)}InterpolantFactoryMethodSmooth(e){return new Wc(this.times,this.values,this.getValueSize(),e)}InterpolantFactoryMethodBezier(e){let t=new $c(this.times,this.values,this.getValueSize(),e);return this.settings&&(t.inTangents=this.settings.inTangents,t.outTangents=this.settings.outTangents),t}setInterpolation(e){let t;switch(e){case la:t=this.InterpolantFactoryMethodDiscrete;break;case Uc:t=this.InterpolantFactoryMethodLinear;break;case Oc:t=this.InterpolantFactoryMethodSmooth;break;case jd:t=this.InterpolantFactoryMethodBezier;break}if(t===void 0){let i="unsupported interpolation for "+this.ValueTypeName+" keyframe track named "+this.name;if(this.createInterpolant===void 0)if(e!==this.DefaultInterpolation)this.setInterpolation(this.DefaultInterpolation);else throw new Error(i);return It("KeyframeTrack:",i),this}return this.createInterpolant=t,this}getInterpolation(){switch(this.createInterpolant){case this.InterpolantFactoryMethodDiscrete:return la;case this.InterpolantFactoryMethodLinear:return Uc;case this.InterpolantFactoryMethodSmooth:return Oc;case this.InterpolantFactoryMethodBezier:return jd}}getValueSize(){return this.values.length/this.times.length}shift(e){if(e!==0){let t=this.times;for(let i=0,n=t.length;i!==n;++i)t[i]+=e;Nc(this.settings)&&(hb(this.settings.inTangents,e),hb(this.settings.outTangents,e))}return this}scale(e){if(e!==1){let t=this.times;for(let i=0,n=t.length;i!==n;++i)t[i]*=e;Nc(this.settings)&&(ub(this.settings.inTangents,e),ub(this.settings.outTangents,e))}return this}trim(e,t){let i=this.times,n=i.length,r=0,o=n-1;for(;r!==n&&i[r]<e;)++r;for(;o!==-1&&i[o]>t;)--o;if(++o,r!==0||o!==n){r>=o&&(o=Math.max(o,1),r=o-1);let a=this.getValueSize();this.times=i.slice(r,o),this.values=this.values.slice(r*a,o*a)}return this}validate(){let e=!0,t=this.getValueSize();t-Math.floor(t)!==0&&(St("KeyframeTrack: Invalid value size in track.",this),e=!1);let i=this.times,n=this.values,r=i.length;r===0&&(St("KeyframeTrack: Track is empty.",this),e=!1);let o=null;for(let a=0;a!==r;a++){let l=i[a];if(typeof l=="number"&&isNaN(l)){St("KeyframeTrack: Time is not a valid number.",this,a,l),e=!1;break}if(o!==null&&o>l){St("KeyframeTrack: Out of order keys.",this,a,l,o),e=!1;break}o=l}if(n!==void 0&&bE(n))for(let a=0,l=n.length;a!==l;++a){let c=n[a];if(isNaN(c)){St("KeyframeTrack: Value is not a valid number.",this,a,c),e=!1;break}}return e}optimize(){let e=this.times.slice(),t=this.values.slice(),i=this.getValueSize(),n=this.getInterpolation()===Oc,r=e.length-1,o=1;for(let a=1;a<r;++a){let l=!1,c=e[a],h=e[a+1];if(c!==h&&(a!==1||c!==e[0]))if(n)l=!0;else{let u=a*i,f=u-i,d=u+i;for(let m=0;m!==i;++m){let g=t[u+m];if(g!==t[f+m]||g!==t[d+m]){l=!0;break}}}if(l){if(a!==o){e[o]=e[a];let u=a*i,f=o*i;for(let d=0;d!==i;++d)t[f+d]=t[u+d]}++o}}if(r>0){e[o]=e[r];for(let a=r*i,l=o*i,c=0;c!==i;++c)t[l+c]=t[a+c];++o}return o!==e.length?(this.times=e.slice(0,o),this.values=t.slice(0,o*i)):(this.times=e,this.values=t),this}clone(){let e=this.times.slice(),t=this.values.slice(),i=this.constructor,n=new i(this.name,e,t);return n.createInterpolant=this.createInterpolant,Nc(this.settings)&&(n.settings={inTangents:this.settings.inTangents.slice(),outTangents:this.settings.outTangents.slice()}),n}};function hb(s,e){for(let t=0,i=s.length;t!==i;t+=2)s[t]+=e}function ub(s,e){for(let t=0,i=s.length;t!==i;t+=2)s[t]*=e}hi.prototype.ValueTypeName="";hi.prototype.TimeBufferType=Float32Array;hi.prototype.ValueBufferType=Float32Array;hi.prototype.DefaultInterpolation=Uc;var Zn=class extends hi{constructor(e,t,i){super(e,t,i)}};Zn.prototype.ValueTypeName="bool";Zn.prototype.ValueBufferType=Array;Zn.prototype.DefaultInterpolation=la;Zn.prototype.InterpolantFactoryMethodLinear=void 0;Zn.prototype.InterpolantFactoryMethodSmooth=void 0;var Yc=class extends hi{constructor(e,t,i,n){super(e,t,i,n)}};Yc.prototype.ValueTypeName="color";var Kc=class extends hi{constructor(e,t,i,n){super(e,t,i,n)}};Kc.prototype.ValueTypeName="number";var Jc=class extends Jn{constructor(e,t,i,n){super(e,t,i,n)}interpolate_(e,t,i,n){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=(i-t)/(n-t),c=e*a;for(let h=c+a;c!==h;c+=4)Tn.slerpFlat(r,0,o,c-a,o,c,l);return r}},ua=class extends hi{constructor(e,t,i,n){super(e,t,i,n)}InterpolantFactoryMethodLinear(e){return new Jc(this.times,this.values,this.getValueSize(),e)}};ua.prototype.ValueTypeName="quaternion";ua.prototype.InterpolantFactoryMethodSmooth=void 0;var jn=class extends hi{constructor(e,t,i){super(e,t,i)}};jn.prototype.ValueTypeName="string";jn.prototype.ValueBufferType=Array;jn.prototype.DefaultInterpolation=la;jn.prototype.InterpolantFactoryMethodLinear=void 0;jn.prototype.InterpolantFactoryMethodSmooth=void 0;var Zc=class extends hi{constructor(e,t,i,n){super(e,t,i,n)}};Zc.prototype.ValueTypeName="vector";var jc=class{constructor(e,t,i){let n=this,r=!1,o=0,a=0,l,c=[];this.onStart=void 0,this.onLoad=e,this.onProgress=t,this.onError=i,this._abortController=null,this.itemStart=function(h){a++,r===!1&&n.onStart!==void 0&&n.onStart(h,o,a),r=!0},this.itemEnd=function(h){o++,n.onProgress!==void 0&&n.onProgress(h,o,a),o===a&&(r=!1,n.onLoad!==void 0&&n.onLoad())},this.itemError=function(h){n.onError!==void 0&&n.onError(h)},this.resolveURL=function(h){return h=h.normalize("NFC"),l?l(h):h},this.setURLModifier=function(h){return l=h,this},this.addHandler=function(h,u){return c.push(h,u),this},this.removeHandler=function(h){let u=c.indexOf(h);return u!==-1&&c.splice(u,2),this},this.getHandler=function(h){for(let u=0,f=c.length;u<f;u+=2){let d=c[u],m=c[u+1];if(d.global&&(d.lastIndex=0),d.test(h))return m}return null},this.abort=function(){return this.abortController.abort(),this._abortController=null,this}}get abortController(){return this._abortController||(this._abortController=new AbortController),this._abortController}},Tb=new jc,Qc=class{constructor(e){this.manager=e!==void 0?e:Tb,this.crossOrigin="anonymous",this.withCredentials=!1,this.path="",this.resourcePath="",this.requestHeader={},this.priority="auto",this.cache="default",typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}load(){}loadAsync(e,t){let i=this;return new Promise(function(n,r){i.load(e,n,t,r)})}parse(){}setCrossOrigin(e){return this.crossOrigin=e,this}setWithCredentials(e){return this.withCredentials=e,this}setPath(e){return this.path=e,this}setResourcePath(e){return this.resourcePath=e,this}setRequestHeader(e){return this.requestHeader=e,this}setPriority(e){return this.priority=e,this}setCache(e){return this.cache=e,this}abort(){return this}};Qc.DEFAULT_MATERIAL_NAME="__DEFAULT";var yp="\\[\\]\\.:\\/",NE=new RegExp("["+yp+"]","g"),bp="[^"+yp+"]",OE="[^"+yp.replace("\\.","")+"]",FE=/((?:WC+[\/:])*)/.source.replace("WC",bp),BE=/(WCOD+)?/.source.replace("WCOD",OE),UE=/(?:\.(WC+)(?:\[(.+)\])?)?/.source.replace("WC",bp),zE=/\.(WC+)(?:\[(.+)\])?/.source.replace("WC",bp),VE=new RegExp("^"+FE+BE+UE+zE+"$"),HE=["material","materials","bones","map"],ap=class{constructor(e,t,i){let n=i||Xe.parseTrackName(t);this._targetGroup=e,this._bindings=e.subscribe_(t,n)}getValue(e,t){this.bind();let i=this._targetGroup.nCachedObjects_,n=this._bindings[i];n!==void 0&&n.getValue(e,t)}setValue(e,t){let i=this._bindings;for(let n=this._targetGroup.nCachedObjects_,r=i.length;n!==r;++n)i[n].setValue(e,t)}bind(){let e=this._bindings;for(let t=this._targetGroup.nCachedObjects_,i=e.length;t!==i;++t)e[t].bind()}unbind(){let e=this._bindings;for(let t=this._targetGroup.nCachedObjects_,i=e.length;t!==i;++t)e[t].unbind()}},Xe=class s{constructor(e,t,i){this.path=t,this.parsedPath=i||s.parseTrackName(t),this.node=s.findNode(e,this.parsedPath.nodeName),this.rootNode=e,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}static create(e,t,i){return e&&e.isAnimationObjectGroup?new s.Composite(e,t,i):new s(e,t,i)}static sanitizeNodeName(e){return e.replace(/\s/g,"_").replace(NE,"")}static parseTrackName(e){let t=VE.exec(e);if(t===null)throw new Error("THREE.PropertyBinding: Cannot parse trackName: "+e);let i={nodeName:t[2],objectName:t[3],objectIndex:t[4],propertyName:t[5],propertyIndex:t[6]},n=i.nodeName&&i.nodeName.lastIndexOf(".");if(n!==void 0&&n!==-1){let r=i.nodeName.substring(n+1);HE.indexOf(r)!==-1&&(i.nodeName=i.nodeName.substring(0,n),i.objectName=r)}if(i.propertyName===null||i.propertyName.length===0)throw new Error("THREE.PropertyBinding: can not parse propertyName from trackName: "+e);return i}static findNode(e,t){if(t===void 0||t===""||t==="."||t===-1||t===e.name||t===e.uuid)return e;if(e.skeleton){let i=e.skeleton.getBoneByName(t);if(i!==void 0)return i}if(e.children){let i=function(r){for(let o=0;o<r.length;o++){let a=r[o];if(a.name===t||a.uuid===t)return a;let l=i(a.children);if(l)return l}return null},n=i(e.children);if(n)return n}return null}_getValue_unavailable(){}_setValue_unavailable(){}_getValue_direct(e,t){e[t]=this.targetObject[this.propertyName]}_getValue_array(e,t){let i=this.resolvedProperty;for(let n=0,r=i.length;n!==r;++n)e[t++]=i[n]}_getValue_arrayElement(e,t){e[t]=this.resolvedProperty[this.propertyIndex]}_getValue_toArray(e,t){this.resolvedProperty.toArray(e,t)}_setValue_direct(e,t){this.targetObject[this.propertyName]=e[t]}_setValue_direct_setNeedsUpdate(e,t){this.targetObject[this.propertyName]=e[t],this.targetObject.needsUpdate=!0}_setValue_direct_setMatrixWorldNeedsUpdate(e,t){this.targetObject[this.propertyName]=e[t],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_array(e,t){let i=this.resolvedProperty;for(let n=0,r=i.length;n!==r;++n)i[n]=e[t++]}_setValue_array_setNeedsUpdate(e,t){let i=this.resolvedProperty;for(let n=0,r=i.length;n!==r;++n)i[n]=e[t++];this.targetObject.needsUpdate=!0}_setValue_array_setMatrixWorldNeedsUpdate(e,t){let i=this.resolvedProperty;for(let n=0,r=i.length;n!==r;++n)i[n]=e[t++];this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_arrayElement(e,t){this.resolvedProperty[this.propertyIndex]=e[t]}_setValue_arrayElement_setNeedsUpdate(e,t){this.resolvedProperty[this.propertyIndex]=e[t],this.targetObject.needsUpdate=!0}_setValue_arrayElement_setMatrixWorldNeedsUpdate(e,t){this.resolvedProperty[this.propertyIndex]=e[t],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_fromArray(e,t){this.resolvedProperty.fromArray(e,t)}_setValue_fromArray_setNeedsUpdate(e,t){this.resolvedProperty.fromArray(e,t),this.targetObject.needsUpdate=!0}_setValue_fromArray_setMatrixWorldNeedsUpdate(e,t){this.resolvedProperty.fromArray(e,t),this.targetObject.matrixWorldNeedsUpdate=!0}_getValue_unbound(e,t){this.bind(),this.getValue(e,t)}_setValue_unbound(e,t){this.bind(),this.setValue(e,t)}bind(){let e=this.node,t=this.parsedPath,i=t.objectName,n=t.propertyName,r=t.propertyIndex;if(e||(e=s.findNode(this.rootNode,t.nodeName),this.node=e),this.getValue=this._getValue_unavailable,this.setValue=this._setValue_unavailable,!e){It("PropertyBinding: No target node found for track: "+this.path+".");return}if(i){let c=t.objectIndex;switch(i){case"materials":if(!e.material){St("PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!e.material.materials){St("PropertyBinding: Can not bind to material.materials as node.material does not have a materials array.",this);return}e=e.material.materials;break;case"bones":if(!e.skeleton){St("PropertyBinding: Can not bind to bones as node does not have a skeleton.",this);return}e=e.skeleton.bones;for(let h=0;h<e.length;h++)if(e[h].name===c){c=h;break}break;case"map":if("map"in e){e=e.map;break}if(!e.material){St("PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!e.material.map){St("PropertyBinding: Can not bind to material.map as node.material does not have a map.",this);return}e=e.material.map;break;default:if(e[i]===void 0){St("PropertyBinding: Can not bind to objectName of node undefined.",this);return}e=e[i]}if(c!==void 0){if(e[c]===void 0){St("PropertyBinding: Trying to bind to objectIndex of objectName, but is undefined.",this,e);return}e=e[c]}}let o=e[n];if(o===void 0){let c=t.nodeName;St("PropertyBinding: Trying to update property for track: "+c+"."+n+" but it wasn't found.",e);return}let a=this.Versioning.None;this.targetObject=e,e.isMaterial===!0?a=this.Versioning.NeedsUpdate:e.isObject3D===!0&&(a=this.Versioning.MatrixWorldNeedsUpdate);let l=this.BindingType.Direct;if(r!==void 0){if(n==="morphTargetInfluences"){if(!e.geometry){St("PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.",this);return}if(!e.geometry.morphAttributes){St("PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.morphAttributes.",this);return}e.morphTargetDictionary[r]!==void 0&&(r=e.morphTargetDictionary[r])}l=this.BindingType.ArrayElement,this.resolvedProperty=o,this.propertyIndex=r}else o.fromArray!==void 0&&o.toArray!==void 0?(l=this.BindingType.HasFromToArray,this.resolvedProperty=o):Array.isArray(o)?(l=this.BindingType.EntireArray,this.resolvedProperty=o):this.propertyName=n;this.getValue=this.GetterByBindingType[l],this.setValue=this.SetterByBindingTypeAndVersioning[l][a]}unbind(){this.node=null,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}};Xe.Composite=ap;Xe.prototype.BindingType={Direct:0,EntireArray:1,ArrayElement:2,HasFromToArray:3};Xe.prototype.Versioning={None:0,NeedsUpdate:1,MatrixWorldNeedsUpdate:2};Xe.prototype.GetterByBindingType=[Xe.prototype._getValue_direct,Xe.prototype._getValue_array,Xe.prototype._getValue_arrayElement,Xe.prototype._getValue_toArray];Xe.prototype.SetterByBindingTypeAndVersioning=[[Xe.prototype._setValue_direct,Xe.prototype._setValue_direct_setNeedsUpdate,Xe.prototype._setValue_direct_setMatrixWorldNeedsUpdate],[Xe.prototype._setValue_array,Xe.prototype._setValue_array_setNeedsUpdate,Xe.prototype._setValue_array_setMatrixWorldNeedsUpdate],[Xe.prototype._setValue_arrayElement,Xe.prototype._setValue_arrayElement_setNeedsUpdate,Xe.prototype._setValue_arrayElement_setMatrixWorldNeedsUpdate],[Xe.prototype._setValue_fromArray,Xe.prototype._setValue_fromArray_setNeedsUpdate,Xe.prototype._setValue_fromArray_setMatrixWorldNeedsUpdate]];var Fk=new Float32Array(1);var lp=class{static{this.prototype.isMatrix2=!0}constructor(e,t,i,n){this.elements=[1,0,0,1],e!==void 0&&this.set(e,t,i,n)}identity(){return this.set(1,0,0,1),this}fromArray(e,t=0){for(let i=0;i<4;i++)this.elements[i]=e[i+t];return this}set(e,t,i,n){let r=this.elements;return r[0]=e,r[2]=t,r[1]=i,r[3]=n,this}};typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("register",{detail:{revision:"187"}}));typeof window<"u"&&(window.__THREE__?It("WARNING: Multiple instances of Three.js being imported."):window.__THREE__="187");var GE=`#ifdef USE_ALPHAHASH
	if ( diffuseColor.a < getAlphaHashThreshold( vPosition ) ) discard;
#endif`,WE=`#ifdef USE_ALPHAHASH
	const float ALPHA_HASH_SCALE = 0.05;
	float hash2D( vec2 value ) {
		return fract( 1.0e4 * sin( 17.0 * value.x + 0.1 * value.y ) * ( 0.1 + abs( sin( 13.0 * value.y + value.x ) ) ) );
	}
	float hash3D( vec3 value ) {
		return hash2D( vec2( hash2D( value.xy ), value.z ) );
	}
	float getAlphaHashThreshold( vec3 position ) {
		float maxDeriv = max(
			length( dFdx( position.xyz ) ),
			length( dFdy( position.xyz ) )
		);
		float pixScale = 1.0 / ( ALPHA_HASH_SCALE * maxDeriv );
		vec2 pixScales = vec2(
			exp2( floor( log2( pixScale ) ) ),
			exp2( ceil( log2( pixScale ) ) )
		);
		vec2 alpha = vec2(
			hash3D( floor( pixScales.x * position.xyz ) ),
			hash3D( floor( pixScales.y * position.xyz ) )
		);
		float lerpFactor = fract( log2( pixScale ) );
		float x = ( 1.0 - lerpFactor ) * alpha.x + lerpFactor * alpha.y;
		float a = min( lerpFactor, 1.0 - lerpFactor );
		vec3 cases = vec3(
			x * x / ( 2.0 * a * ( 1.0 - a ) ),
			( x - 0.5 * a ) / ( 1.0 - a ),
			1.0 - ( ( 1.0 - x ) * ( 1.0 - x ) / ( 2.0 * a * ( 1.0 - a ) ) )
		);
		float threshold = ( x < ( 1.0 - a ) )
			? ( ( x < a ) ? cases.x : cases.y )
			: cases.z;
		return clamp( threshold , 1.0e-6, 1.0 );
	}
#endif`,qE=`#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, vAlphaMapUv ).g;
#endif`,XE=`#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,$E=`#ifdef USE_ALPHATEST
	#ifdef ALPHA_TO_COVERAGE
	diffuseColor.a = smoothstep( alphaTest, alphaTest + fwidth( diffuseColor.a ), diffuseColor.a );
	if ( diffuseColor.a == 0.0 ) discard;
	#else
	if ( diffuseColor.a < alphaTest ) discard;
	#endif
#endif`,YE=`#ifdef USE_ALPHATEST
	uniform float alphaTest;
#endif`,KE=`#ifdef USE_AOMAP
	float ambientOcclusion = ( texture2D( aoMap, vAoMapUv ).r - 1.0 ) * aoMapIntensity + 1.0;
	reflectedLight.indirectDiffuse *= ambientOcclusion;
	#if defined( USE_CLEARCOAT ) 
		clearcoatSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_SHEEN ) 
		sheenSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_ENVMAP ) && defined( STANDARD )
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		reflectedLight.indirectSpecular *= computeSpecularOcclusion( dotNV, ambientOcclusion, material.roughness );
	#endif
#endif`,JE=`#ifdef USE_AOMAP
	uniform sampler2D aoMap;
	uniform float aoMapIntensity;
#endif`,ZE=`#ifdef USE_BATCHING
	#if ! defined( GL_ANGLE_multi_draw )
	#define gl_DrawID _gl_DrawID
	uniform int _gl_DrawID;
	#endif
	uniform highp sampler2D batchingTexture;
	uniform highp usampler2D batchingIdTexture;
	mat4 getBatchingMatrix( const in float i ) {
		int size = textureSize( batchingTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( batchingTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( batchingTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( batchingTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( batchingTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
	float getIndirectIndex( const in int i ) {
		int size = textureSize( batchingIdTexture, 0 ).x;
		int x = i % size;
		int y = i / size;
		return float( texelFetch( batchingIdTexture, ivec2( x, y ), 0 ).r );
	}
#endif
#ifdef USE_BATCHING_COLOR
	uniform sampler2D batchingColorTexture;
	vec4 getBatchingColor( const in float i ) {
		int size = textureSize( batchingColorTexture, 0 ).x;
		int j = int( i );
		int x = j % size;
		int y = j / size;
		return texelFetch( batchingColorTexture, ivec2( x, y ), 0 );
	}
#endif`,jE=`#ifdef USE_BATCHING
	mat4 batchingMatrix = getBatchingMatrix( getIndirectIndex( gl_DrawID ) );
#endif`,QE=`vec3 transformed = vec3( position );
#ifdef USE_ALPHAHASH
	vPosition = vec3( position );
#endif`,eC=`vec3 objectNormal = vec3( normal );
#ifdef USE_TANGENT
	vec3 objectTangent = vec3( tangent.xyz );
#endif`,tC=`float G_BlinnPhong_Implicit( ) {
	return 0.25;
}
float D_BlinnPhong( const in float shininess, const in float dotNH ) {
	return RECIPROCAL_PI * ( shininess * 0.5 + 1.0 ) * pow( dotNH, shininess );
}
vec3 BRDF_BlinnPhong( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 specularColor, const in float shininess ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( specularColor, 1.0, dotVH );
	float G = G_BlinnPhong_Implicit( );
	float D = D_BlinnPhong( shininess, dotNH );
	return F * ( G * D );
} // validated`,iC=`#ifdef USE_IRIDESCENCE
	const mat3 XYZ_TO_REC709 = mat3(
		 3.2404542, -0.9692660,  0.0556434,
		-1.5371385,  1.8760108, -0.2040259,
		-0.4985314,  0.0415560,  1.0572252
	);
	vec3 Fresnel0ToIor( vec3 fresnel0 ) {
		vec3 sqrtF0 = sqrt( fresnel0 );
		return ( vec3( 1.0 ) + sqrtF0 ) / ( vec3( 1.0 ) - sqrtF0 );
	}
	vec3 IorToFresnel0( vec3 transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - vec3( incidentIor ) ) / ( transmittedIor + vec3( incidentIor ) ) );
	}
	float IorToFresnel0( float transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - incidentIor ) / ( transmittedIor + incidentIor ));
	}
	vec3 evalSensitivity( float OPD, vec3 shift ) {
		float phase = 2.0 * PI * OPD * 1.0e-9;
		vec3 val = vec3( 5.4856e-13, 4.4201e-13, 5.2481e-13 );
		vec3 pos = vec3( 1.6810e+06, 1.7953e+06, 2.2084e+06 );
		vec3 var = vec3( 4.3278e+09, 9.3046e+09, 6.6121e+09 );
		vec3 xyz = val * sqrt( 2.0 * PI * var ) * cos( pos * phase + shift ) * exp( - pow2( phase ) * var );
		xyz.x += 9.7470e-14 * sqrt( 2.0 * PI * 4.5282e+09 ) * cos( 2.2399e+06 * phase + shift[ 0 ] ) * exp( - 4.5282e+09 * pow2( phase ) );
		xyz /= 1.0685e-7;
		vec3 rgb = XYZ_TO_REC709 * xyz;
		return rgb;
	}
	vec3 evalIridescence( float outsideIOR, float eta2, float cosTheta1, float thinFilmThickness, vec3 baseF0 ) {
		vec3 I;
		float iridescenceIOR = mix( outsideIOR, eta2, smoothstep( 0.0, 0.03, thinFilmThickness ) );
		float sinTheta2Sq = pow2( outsideIOR / iridescenceIOR ) * ( 1.0 - pow2( cosTheta1 ) );
		float cosTheta2Sq = 1.0 - sinTheta2Sq;
		if ( cosTheta2Sq < 0.0 ) {
			return vec3( 1.0 );
		}
		float cosTheta2 = sqrt( cosTheta2Sq );
		float R0 = IorToFresnel0( iridescenceIOR, outsideIOR );
		float R12 = F_Schlick( R0, 1.0, cosTheta1 );
		float T121 = 1.0 - R12;
		float phi12 = 0.0;
		if ( iridescenceIOR < outsideIOR ) phi12 = PI;
		float phi21 = PI - phi12;
		vec3 baseIOR = Fresnel0ToIor( clamp( baseF0, 0.0, 0.9999 ) );		vec3 R1 = IorToFresnel0( baseIOR, iridescenceIOR );
		vec3 R23 = F_Schlick( R1, 1.0, cosTheta2 );
		vec3 phi23 = vec3( 0.0 );
		if ( baseIOR[ 0 ] < iridescenceIOR ) phi23[ 0 ] = PI;
		if ( baseIOR[ 1 ] < iridescenceIOR ) phi23[ 1 ] = PI;
		if ( baseIOR[ 2 ] < iridescenceIOR ) phi23[ 2 ] = PI;
		float OPD = 2.0 * iridescenceIOR * thinFilmThickness * cosTheta2;
		vec3 phi = vec3( phi21 ) + phi23;
		vec3 R123 = clamp( R12 * R23, 1e-5, 0.9999 );
		vec3 r123 = sqrt( R123 );
		vec3 Rs = pow2( T121 ) * R23 / ( vec3( 1.0 ) - R123 );
		vec3 C0 = R12 + Rs;
		I = C0;
		vec3 Cm = Rs - T121;
		for ( int m = 1; m <= 2; ++ m ) {
			Cm *= r123;
			vec3 Sm = 2.0 * evalSensitivity( float( m ) * OPD, float( m ) * phi );
			I += Cm * Sm;
		}
		return max( I, vec3( 0.0 ) );
	}
#endif`,nC=`#ifdef USE_BUMPMAP
	uniform sampler2D bumpMap;
	uniform float bumpScale;
	vec2 dHdxy_fwd() {
		vec2 dSTdx = dFdx( vBumpMapUv );
		vec2 dSTdy = dFdy( vBumpMapUv );
		float Hll = bumpScale * texture2D( bumpMap, vBumpMapUv ).x;
		float dBx = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdx ).x - Hll;
		float dBy = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdy ).x - Hll;
		return vec2( dBx, dBy );
	}
	vec3 perturbNormalArb( vec3 surf_pos, vec3 surf_norm, vec2 dHdxy, float faceDirection ) {
		vec3 vSigmaX = normalize( dFdx( surf_pos.xyz ) );
		vec3 vSigmaY = normalize( dFdy( surf_pos.xyz ) );
		vec3 vN = surf_norm;
		vec3 R1 = cross( vSigmaY, vN );
		vec3 R2 = cross( vN, vSigmaX );
		float fDet = dot( vSigmaX, R1 ) * faceDirection;
		vec3 vGrad = sign( fDet ) * ( dHdxy.x * R1 + dHdxy.y * R2 );
		return normalize( abs( fDet ) * surf_norm - vGrad );
	}
#endif`,sC=`#if NUM_CLIPPING_PLANES > 0
	vec4 plane;
	#ifdef ALPHA_TO_COVERAGE
		float distanceToPlane, distanceGradient;
		float clipOpacity = 1.0;
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
			distanceGradient = fwidth( distanceToPlane ) / 2.0;
			clipOpacity *= smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			if ( clipOpacity == 0.0 ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			float unionClipOpacity = 1.0;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
				distanceGradient = fwidth( distanceToPlane ) / 2.0;
				unionClipOpacity *= 1.0 - smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			}
			#pragma unroll_loop_end
			clipOpacity *= 1.0 - unionClipOpacity;
		#endif
		diffuseColor.a *= clipOpacity;
		if ( diffuseColor.a == 0.0 ) discard;
	#else
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			if ( dot( vClipPosition, plane.xyz ) > plane.w ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			bool clipped = true;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				clipped = ( dot( vClipPosition, plane.xyz ) > plane.w ) && clipped;
			}
			#pragma unroll_loop_end
			if ( clipped ) discard;
		#endif
	#endif
#endif`,rC=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
	uniform vec4 clippingPlanes[ NUM_CLIPPING_PLANES ];
#endif`,oC=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
#endif`,aC=`#if NUM_CLIPPING_PLANES > 0
	vClipPosition = - mvPosition.xyz;
#endif`,lC=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	diffuseColor *= vColor;
#endif`,cC=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	varying vec4 vColor;
#endif`,hC=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	varying vec4 vColor;
#endif`,uC=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	vColor = vec4( 1.0 );
#endif
#ifdef USE_COLOR_ALPHA
	vColor *= color;
#elif defined( USE_COLOR )
	vColor.rgb *= color;
#endif
#ifdef USE_INSTANCING_COLOR
	vColor.rgb *= instanceColor.rgb;
#endif
#ifdef USE_BATCHING_COLOR
	vColor *= getBatchingColor( getIndirectIndex( gl_DrawID ) );
#endif`,fC=`#define PI 3.141592653589793
#define PI2 6.283185307179586
#define PI_HALF 1.5707963267948966
#define RECIPROCAL_PI 0.3183098861837907
#define RECIPROCAL_PI2 0.15915494309189535
#define EPSILON 1e-6
#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
#define whiteComplement( a ) ( 1.0 - saturate( a ) )
float pow2( const in float x ) { return x*x; }
vec3 pow2( const in vec3 x ) { return x*x; }
float pow3( const in float x ) { return x*x*x; }
float pow4( const in float x ) { float x2 = x*x; return x2*x2; }
float max3( const in vec3 v ) { return max( max( v.x, v.y ), v.z ); }
float average( const in vec3 v ) { return dot( v, vec3( 0.3333333 ) ); }
highp float rand( const in vec2 uv ) {
	const highp float a = 12.9898, b = 78.233, c = 43758.5453;
	highp float dt = dot( uv.xy, vec2( a,b ) ), sn = mod( dt, PI );
	return fract( sin( sn ) * c );
}
#ifdef HIGH_PRECISION
	float precisionSafeLength( vec3 v ) { return length( v ); }
#else
	float precisionSafeLength( vec3 v ) {
		float maxComponent = max3( abs( v ) );
		return length( v / maxComponent ) * maxComponent;
	}
#endif
struct IncidentLight {
	vec3 color;
	vec3 direction;
	bool visible;
};
struct ReflectedLight {
	vec3 directDiffuse;
	vec3 directSpecular;
	vec3 indirectDiffuse;
	vec3 indirectSpecular;
};
#ifdef USE_ALPHAHASH
	varying vec3 vPosition;
#endif
vec3 transformDirection( in vec3 dir, in mat4 matrix ) {
	return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );
}
#define inverseTransformDirection transformDirectionByInverseViewMatrix
vec3 transformNormalByInverseViewMatrix( in vec3 normal, in mat4 viewMatrix ) {
	return normalize( ( vec4( normal, 0.0 ) * viewMatrix ).xyz );
}
vec3 transformDirectionByInverseViewMatrix( in vec3 dir, in mat4 viewMatrix ) {
	return normalize( ( vec4( dir, 0.0 ) * viewMatrix ).xyz );
}
bool isPerspectiveMatrix( mat4 m ) {
	return m[ 2 ][ 3 ] == - 1.0;
}
vec2 equirectUv( in vec3 dir ) {
	float u = atan( dir.z, dir.x ) * RECIPROCAL_PI2 + 0.5;
	float v = asin( clamp( dir.y, - 1.0, 1.0 ) ) * RECIPROCAL_PI + 0.5;
	return vec2( u, v );
}
vec3 BRDF_Lambert( const in vec3 diffuseColor ) {
	return RECIPROCAL_PI * diffuseColor;
}
vec3 F_Schlick( const in vec3 f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
}
float F_Schlick( const in float f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
} // validated`,dC=`vec3 transformedNormal = objectNormal;
#ifdef USE_TANGENT
	vec3 transformedTangent = objectTangent;
#endif
#ifdef USE_BATCHING
	mat3 bm = mat3( batchingMatrix );
	transformedNormal /= vec3( dot( bm[ 0 ], bm[ 0 ] ), dot( bm[ 1 ], bm[ 1 ] ), dot( bm[ 2 ], bm[ 2 ] ) );
	transformedNormal = bm * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = bm * transformedTangent;
	#endif
#endif
#ifdef USE_INSTANCING
	mat3 im = mat3( instanceMatrix );
	transformedNormal /= vec3( dot( im[ 0 ], im[ 0 ] ), dot( im[ 1 ], im[ 1 ] ), dot( im[ 2 ], im[ 2 ] ) );
	transformedNormal = im * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = im * transformedTangent;
	#endif
#endif
transformedNormal = normalMatrix * transformedNormal;
#ifdef FLIP_SIDED
	transformedNormal = - transformedNormal;
#endif
#ifdef USE_TANGENT
	transformedTangent = ( modelViewMatrix * vec4( transformedTangent, 0.0 ) ).xyz;
#endif`,pC=`#ifdef USE_DISPLACEMENTMAP
	uniform sampler2D displacementMap;
	uniform float displacementScale;
	uniform float displacementBias;
#endif`,mC=`#ifdef USE_DISPLACEMENTMAP
	transformed += normalize( objectNormal ) * ( texture2D( displacementMap, vDisplacementMapUv ).x * displacementScale + displacementBias );
#endif`,gC=`#ifdef USE_EMISSIVEMAP
	vec4 emissiveColor = texture2D( emissiveMap, vEmissiveMapUv );
	#ifdef DECODE_VIDEO_TEXTURE_EMISSIVE
		emissiveColor = sRGBTransferEOTF( emissiveColor );
	#endif
	totalEmissiveRadiance *= emissiveColor.rgb;
#endif`,xC=`#ifdef USE_EMISSIVEMAP
	uniform sampler2D emissiveMap;
#endif`,vC="gl_FragColor = linearToOutputTexel( gl_FragColor );",yC=`vec4 LinearTransferOETF( in vec4 value ) {
	return value;
}
vec4 sRGBTransferEOTF( in vec4 value ) {
	return vec4( mix( pow( value.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), value.rgb * 0.0773993808, vec3( lessThanEqual( value.rgb, vec3( 0.04045 ) ) ) ), value.a );
}
vec4 sRGBTransferOETF( in vec4 value ) {
	return vec4( mix( pow( value.rgb, vec3( 0.41666 ) ) * 1.055 - vec3( 0.055 ), value.rgb * 12.92, vec3( lessThanEqual( value.rgb, vec3( 0.0031308 ) ) ) ), value.a );
}`,bC=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vec3 cameraToFrag;
		if ( isOrthographic ) {
			cameraToFrag = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToFrag = normalize( vWorldPosition - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vec3 reflectVec = reflect( cameraToFrag, worldNormal );
		#else
			vec3 reflectVec = refract( cameraToFrag, worldNormal, refractionRatio );
		#endif
	#else
		vec3 reflectVec = vReflect;
	#endif
	#ifdef ENVMAP_TYPE_CUBE
		vec4 envColor = textureCube( envMap, envMapRotation * reflectVec );
		#ifdef ENVMAP_BLENDING_MULTIPLY
			outgoingLight = mix( outgoingLight, outgoingLight * envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_MIX )
			outgoingLight = mix( outgoingLight, envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_ADD )
			outgoingLight += envColor.xyz * specularStrength * reflectivity;
		#endif
	#endif
#endif`,_C=`#ifdef USE_ENVMAP
	uniform float envMapIntensity;
	uniform mat3 envMapRotation;
	uniform samplerCube envMap;
	#ifdef ENVMAP_TYPE_PMREM
		float roughnessToMip( const in float roughness ) {
			float r = clamp( roughness, 0.0, 1.0 );
			return ENVMAP_MAX_LOD * r * ( 2.0 - r );
		}
	#endif
#endif`,SC=`#ifdef USE_ENVMAP
	uniform float reflectivity;
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		varying vec3 vWorldPosition;
		uniform float refractionRatio;
	#else
		varying vec3 vReflect;
	#endif
#endif`,wC=`#ifdef USE_ENVMAP
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		
		varying vec3 vWorldPosition;
	#else
		varying vec3 vReflect;
		uniform float refractionRatio;
	#endif
#endif`,MC=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vWorldPosition = worldPosition.xyz;
	#else
		vec3 cameraToVertex;
		if ( isOrthographic ) {
			cameraToVertex = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToVertex = normalize( worldPosition.xyz - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vReflect = reflect( cameraToVertex, worldNormal );
		#else
			vReflect = refract( cameraToVertex, worldNormal, refractionRatio );
		#endif
	#endif
#endif`,AC=`#ifdef USE_FOG
	vFogDepth = - mvPosition.z;
#endif`,TC=`#ifdef USE_FOG
	varying float vFogDepth;
#endif`,EC=`#ifdef USE_FOG
	#ifdef FOG_EXP2
		float fogFactor = 1.0 - exp( - fogDensity * fogDensity * vFogDepth * vFogDepth );
	#else
		float fogFactor = smoothstep( fogNear, fogFar, vFogDepth );
	#endif
	gl_FragColor.rgb = mix( gl_FragColor.rgb, fogColor, fogFactor );
#endif`,CC=`#ifdef USE_FOG
	uniform vec3 fogColor;
	varying float vFogDepth;
	#ifdef FOG_EXP2
		uniform float fogDensity;
	#else
		uniform float fogNear;
		uniform float fogFar;
	#endif
#endif`,RC=`#ifdef USE_GRADIENTMAP
	uniform sampler2D gradientMap;
#endif
vec3 getGradientIrradiance( vec3 normal, vec3 lightDirection ) {
	float dotNL = dot( normal, lightDirection );
	vec2 coord = vec2( dotNL * 0.5 + 0.5, 0.0 );
	#ifdef USE_GRADIENTMAP
		return vec3( texture2D( gradientMap, coord ).r );
	#else
		vec2 fw = fwidth( coord ) * 0.5;
		return mix( vec3( 0.7 ), vec3( 1.0 ), smoothstep( 0.7 - fw.x, 0.7 + fw.x, coord.x ) );
	#endif
}`,PC=`#ifdef USE_LIGHTMAP
	uniform sampler2D lightMap;
	uniform float lightMapIntensity;
#endif`,kC=`LambertMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularStrength = specularStrength;`,LC=`varying vec3 vViewPosition;
struct LambertMaterial {
	vec3 diffuseColor;
	float specularStrength;
};
void RE_Direct_Lambert( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Lambert( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Lambert
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Lambert`,IC=`uniform bool receiveShadow;
uniform vec3 ambientLightColor;
#if defined( USE_LIGHT_PROBES )
	uniform vec3 lightProbe[ 9 ];
#endif
vec3 shGetIrradianceAt( in vec3 normal, in vec3 shCoefficients[ 9 ] ) {
	float x = normal.x, y = normal.y, z = normal.z;
	vec3 result = shCoefficients[ 0 ] * 0.886227;
	result += shCoefficients[ 1 ] * 2.0 * 0.511664 * y;
	result += shCoefficients[ 2 ] * 2.0 * 0.511664 * z;
	result += shCoefficients[ 3 ] * 2.0 * 0.511664 * x;
	result += shCoefficients[ 4 ] * 2.0 * 0.429043 * x * y;
	result += shCoefficients[ 5 ] * 2.0 * 0.429043 * y * z;
	result += shCoefficients[ 6 ] * ( 0.743125 * z * z - 0.247708 );
	result += shCoefficients[ 7 ] * 2.0 * 0.429043 * x * z;
	result += shCoefficients[ 8 ] * 0.429043 * ( x * x - y * y );
	return result;
}
vec3 getLightProbeIrradiance( const in vec3 lightProbe[ 9 ], const in vec3 normal ) {
	vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec3 irradiance = shGetIrradianceAt( worldNormal, lightProbe );
	return irradiance;
}
vec3 getAmbientLightIrradiance( const in vec3 ambientLightColor ) {
	vec3 irradiance = ambientLightColor;
	return irradiance;
}
float getDistanceAttenuation( const in float lightDistance, const in float cutoffDistance, const in float decayExponent ) {
	float distanceFalloff = 1.0 / max( pow( lightDistance, decayExponent ), 0.01 );
	if ( cutoffDistance > 0.0 ) {
		distanceFalloff *= pow2( saturate( 1.0 - pow4( lightDistance / cutoffDistance ) ) );
	}
	return distanceFalloff;
}
float getSpotAttenuation( const in float coneCosine, const in float penumbraCosine, const in float angleCosine ) {
	return smoothstep( coneCosine, penumbraCosine, angleCosine );
}
#if NUM_SUN_LIGHTS > 0
	struct SunLight {
		vec3 direction;
		vec3 color;
	};
	uniform SunLight sunLights[ NUM_SUN_LIGHTS ];
	void getSunLightInfo( const in SunLight sunLight, out IncidentLight light ) {
		light.color = sunLight.color;
		light.direction = sunLight.direction;
		light.visible = true;
	}
#endif
#if NUM_DIR_LIGHTS > 0
	struct DirectionalLight {
		vec3 direction;
		vec3 color;
	};
	uniform DirectionalLight directionalLights[ NUM_DIR_LIGHTS ];
	void getDirectionalLightInfo( const in DirectionalLight directionalLight, out IncidentLight light ) {
		light.color = directionalLight.color;
		light.direction = directionalLight.direction;
		light.visible = true;
	}
#endif
#if NUM_POINT_LIGHTS > 0
	struct PointLight {
		vec3 position;
		vec3 color;
		float distance;
		float decay;
	};
	uniform PointLight pointLights[ NUM_POINT_LIGHTS ];
	void getPointLightInfo( const in PointLight pointLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = pointLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float lightDistance = length( lVector );
		light.color = pointLight.color;
		light.color *= getDistanceAttenuation( lightDistance, pointLight.distance, pointLight.decay );
		light.visible = ( light.color != vec3( 0.0 ) );
	}
#endif
#if NUM_SPOT_LIGHTS > 0
	struct SpotLight {
		vec3 position;
		vec3 direction;
		vec3 color;
		float distance;
		float decay;
		float coneCos;
		float penumbraCos;
	};
	uniform SpotLight spotLights[ NUM_SPOT_LIGHTS ];
	void getSpotLightInfo( const in SpotLight spotLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = spotLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float angleCos = dot( light.direction, spotLight.direction );
		float spotAttenuation = getSpotAttenuation( spotLight.coneCos, spotLight.penumbraCos, angleCos );
		if ( spotAttenuation > 0.0 ) {
			float lightDistance = length( lVector );
			light.color = spotLight.color * spotAttenuation;
			light.color *= getDistanceAttenuation( lightDistance, spotLight.distance, spotLight.decay );
			light.visible = ( light.color != vec3( 0.0 ) );
		} else {
			light.color = vec3( 0.0 );
			light.visible = false;
		}
	}
#endif
#if NUM_RECT_AREA_LIGHTS > 0
	struct RectAreaLight {
		vec3 color;
		vec3 position;
		vec3 halfWidth;
		vec3 halfHeight;
	};
	uniform sampler2D ltc_1;	uniform sampler2D ltc_2;
	uniform RectAreaLight rectAreaLights[ NUM_RECT_AREA_LIGHTS ];
#endif
#if NUM_HEMI_LIGHTS > 0
	struct HemisphereLight {
		vec3 direction;
		vec3 skyColor;
		vec3 groundColor;
	};
	uniform HemisphereLight hemisphereLights[ NUM_HEMI_LIGHTS ];
	vec3 getHemisphereLightIrradiance( const in HemisphereLight hemiLight, const in vec3 normal ) {
		float dotNL = dot( normal, hemiLight.direction );
		float hemiDiffuseWeight = 0.5 * dotNL + 0.5;
		vec3 irradiance = mix( hemiLight.groundColor, hemiLight.skyColor, hemiDiffuseWeight );
		return irradiance;
	}
#endif
#include <lightprobes_pars_fragment>`,DC=`#ifdef USE_ENVMAP
	vec3 getIBLIrradiance( const in vec3 normal ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * worldNormal, ENVMAP_MAX_LOD );
			return PI * envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	vec3 getIBLRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 reflectVec = reflect( - viewDir, normal );
			reflectVec = normalize( mix( reflectVec, normal, pow4( roughness ) ) );
			reflectVec = transformDirectionByInverseViewMatrix( reflectVec, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * reflectVec, roughnessToMip( roughness ) );
			return envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	#ifdef USE_RETROREFLECTION
		vec3 getIBLRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 retroVec = normalize( mix( viewDir, normal, pow4( roughness ) ) );
				retroVec = transformDirectionByInverseViewMatrix( retroVec, viewMatrix );
				vec4 envMapColor = textureLod( envMap, envMapRotation * retroVec, roughnessToMip( roughness ) );
				return envMapColor.rgb * envMapIntensity;
			#else
				return vec3( 0.0 );
			#endif
		}
	#endif
	#ifdef USE_ANISOTROPY
		vec3 getIBLAnisotropyRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 bentNormal = cross( bitangent, viewDir );
				bentNormal = normalize( cross( bentNormal, bitangent ) );
				bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
				return getIBLRadiance( viewDir, bentNormal, roughness );
			#else
				return vec3( 0.0 );
			#endif
		}
		#ifdef USE_RETROREFLECTION
			vec3 getIBLAnisotropyRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
				#ifdef ENVMAP_TYPE_PMREM
					vec3 bentNormal = cross( bitangent, viewDir );
					bentNormal = normalize( cross( bentNormal, bitangent ) );
					bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
					return getIBLRetroRadiance( viewDir, bentNormal, roughness );
				#else
					return vec3( 0.0 );
				#endif
			}
		#endif
	#endif
#endif`,NC=`ToonMaterial material;
material.diffuseColor = diffuseColor.rgb;`,OC=`varying vec3 vViewPosition;
struct ToonMaterial {
	vec3 diffuseColor;
};
void RE_Direct_Toon( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 irradiance = getGradientIrradiance( geometryNormal, directLight.direction ) * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Toon( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Toon
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Toon`,FC=`BlinnPhongMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularColor = specular;
material.specularShininess = shininess;
material.specularStrength = specularStrength;`,BC=`varying vec3 vViewPosition;
struct BlinnPhongMaterial {
	vec3 diffuseColor;
	vec3 specularColor;
	float specularShininess;
	float specularStrength;
};
void RE_Direct_BlinnPhong( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
	reflectedLight.directSpecular += irradiance * BRDF_BlinnPhong( directLight.direction, geometryViewDir, geometryNormal, material.specularColor, material.specularShininess ) * material.specularStrength;
}
void RE_IndirectDiffuse_BlinnPhong( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_BlinnPhong
#define RE_IndirectDiffuse		RE_IndirectDiffuse_BlinnPhong`,UC=`PhysicalMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.diffuseContribution = diffuseColor.rgb * ( 1.0 - metalnessFactor );
material.metalness = metalnessFactor;
vec3 dxy = max( abs( dFdx( nonPerturbedNormal ) ), abs( dFdy( nonPerturbedNormal ) ) );
float geometryRoughness = max( max( dxy.x, dxy.y ), dxy.z );
material.roughness = max( roughnessFactor, 0.045 );
material.roughness += geometryRoughness;
material.roughness = min( material.roughness, 1.0 );
#ifdef USE_DIFFUSE_ROUGHNESS
	float diffuseRoughnessFactor = diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		diffuseRoughnessFactor *= texture2D( diffuseRoughnessMap, vDiffuseRoughnessMapUv ).r;
	#endif
	material.diffuseRoughness = saturate( diffuseRoughnessFactor );
#endif
#ifdef IOR
	material.ior = ior;
	#ifdef USE_SPECULAR
		float specularIntensityFactor = specularIntensity;
		vec3 specularColorFactor = specularColor;
		#ifdef USE_SPECULAR_COLORMAP
			specularColorFactor *= texture2D( specularColorMap, vSpecularColorMapUv ).rgb;
		#endif
		#ifdef USE_SPECULAR_INTENSITYMAP
			specularIntensityFactor *= texture2D( specularIntensityMap, vSpecularIntensityMapUv ).a;
		#endif
		material.specularF90 = mix( specularIntensityFactor, 1.0, metalnessFactor );
	#else
		float specularIntensityFactor = 1.0;
		vec3 specularColorFactor = vec3( 1.0 );
		material.specularF90 = 1.0;
	#endif
	material.specularColor = min( pow2( ( material.ior - 1.0 ) / ( material.ior + 1.0 ) ) * specularColorFactor, vec3( 1.0 ) ) * specularIntensityFactor;
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
#else
	material.specularColor = vec3( 0.04 );
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
	material.specularF90 = 1.0;
#endif
#ifdef USE_CLEARCOAT
	material.clearcoat = clearcoat;
	material.clearcoatRoughness = clearcoatRoughness;
	material.clearcoatF0 = vec3( 0.04 );
	material.clearcoatF90 = 1.0;
	#ifdef USE_CLEARCOATMAP
		material.clearcoat *= texture2D( clearcoatMap, vClearcoatMapUv ).x;
	#endif
	#ifdef USE_CLEARCOAT_ROUGHNESSMAP
		material.clearcoatRoughness *= texture2D( clearcoatRoughnessMap, vClearcoatRoughnessMapUv ).y;
	#endif
	material.clearcoat = saturate( material.clearcoat );	material.clearcoatRoughness = max( material.clearcoatRoughness, 0.045 );
	material.clearcoatRoughness += geometryRoughness;
	material.clearcoatRoughness = min( material.clearcoatRoughness, 1.0 );
#endif
#ifdef USE_DISPERSION
	material.dispersion = dispersion;
#endif
#ifdef USE_RETROREFLECTION
	material.retroreflectivity = retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	material.iridescence = iridescence;
	material.iridescenceIOR = iridescenceIOR;
	#ifdef USE_IRIDESCENCEMAP
		material.iridescence *= texture2D( iridescenceMap, vIridescenceMapUv ).r;
	#endif
	#ifdef USE_IRIDESCENCE_THICKNESSMAP
		material.iridescenceThickness = (iridescenceThicknessMaximum - iridescenceThicknessMinimum) * texture2D( iridescenceThicknessMap, vIridescenceThicknessMapUv ).g + iridescenceThicknessMinimum;
	#else
		material.iridescenceThickness = iridescenceThicknessMaximum;
	#endif
#endif
#ifdef USE_SHEEN
	material.sheenColor = sheenColor;
	#ifdef USE_SHEEN_COLORMAP
		material.sheenColor *= texture2D( sheenColorMap, vSheenColorMapUv ).rgb;
	#endif
	material.sheenRoughness = clamp( sheenRoughness, 0.0001, 1.0 );
	#ifdef USE_SHEEN_ROUGHNESSMAP
		material.sheenRoughness *= texture2D( sheenRoughnessMap, vSheenRoughnessMapUv ).a;
	#endif
#endif
#ifdef USE_ANISOTROPY
	#ifdef USE_ANISOTROPYMAP
		mat2 anisotropyMat = mat2( anisotropyVector.x, anisotropyVector.y, - anisotropyVector.y, anisotropyVector.x );
		vec3 anisotropyPolar = texture2D( anisotropyMap, vAnisotropyMapUv ).rgb;
		vec2 anisotropyV = anisotropyMat * normalize( 2.0 * anisotropyPolar.rg - vec2( 1.0 ) ) * anisotropyPolar.b;
	#else
		vec2 anisotropyV = anisotropyVector;
	#endif
	material.anisotropy = length( anisotropyV );
	if( material.anisotropy == 0.0 ) {
		anisotropyV = vec2( 1.0, 0.0 );
	} else {
		anisotropyV /= material.anisotropy;
		material.anisotropy = saturate( material.anisotropy );
	}
	material.alphaT = mix( pow2( material.roughness ), 1.0, pow2( material.anisotropy ) );
	material.anisotropyT = tbn[ 0 ] * anisotropyV.x + tbn[ 1 ] * anisotropyV.y;
	material.anisotropyB = tbn[ 1 ] * anisotropyV.x - tbn[ 0 ] * anisotropyV.y;
#endif`,zC=`uniform sampler2D dfgLUT;
struct PhysicalMaterial {
	vec3 diffuseColor;
	vec3 diffuseContribution;
	vec3 specularColor;
	vec3 specularColorBlended;
	float roughness;
	float metalness;
	float specularF90;
	float dispersion;
	vec2 dfg;
	vec3 multiScatteringCompensation;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float diffuseRoughness;
	#endif
	#ifdef USE_RETROREFLECTION
		float retroreflectivity;
	#endif
	#ifdef USE_CLEARCOAT
		float clearcoat;
		float clearcoatRoughness;
		vec3 clearcoatF0;
		float clearcoatF90;
	#endif
	#ifdef USE_IRIDESCENCE
		float iridescence;
		float iridescenceIOR;
		float iridescenceThickness;
		vec3 iridescenceFresnel;
		vec3 iridescenceF0Dielectric;
		vec3 iridescenceF0Metallic;
	#endif
	#ifdef USE_SHEEN
		vec3 sheenColor;
		float sheenRoughness;
	#endif
	#ifdef IOR
		float ior;
	#endif
	#ifdef USE_TRANSMISSION
		float transmission;
		float transmissionAlpha;
		float thickness;
		float attenuationDistance;
		vec3 attenuationColor;
	#endif
	#ifdef USE_ANISOTROPY
		float anisotropy;
		float alphaT;
		vec3 anisotropyT;
		vec3 anisotropyB;
	#endif
};
vec3 clearcoatSpecularDirect = vec3( 0.0 );
vec3 clearcoatSpecularIndirect = vec3( 0.0 );
vec3 sheenSpecularDirect = vec3( 0.0 );
vec3 sheenSpecularIndirect = vec3(0.0 );
vec3 Schlick_to_F0( const in vec3 f, const in float f90, const in float dotVH ) {
    float x = clamp( 1.0 - dotVH, 0.0, 1.0 );
    float x2 = x * x;
    float x5 = clamp( x * x2 * x2, 0.0, 0.9999 );
    return ( f - vec3( f90 ) * x5 ) / ( 1.0 - x5 );
}
#ifdef USE_DIFFUSE_ROUGHNESS
	const float EON_EPSILON = 1e-7;
	float FON_DirectionalAlbedo( const in float mu, const in float roughness, const in float A ) {
		float muComp = 1.0 - mu;
		float gOverPi = muComp * ( 0.0571085289 + muComp * ( 0.491881867 + muComp * ( - 0.332181442 + muComp * 0.0714429953 ) ) );
		return A * ( 1.0 + roughness * gOverPi );
	}
	vec3 BRDF_EON( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 diffuseColor, const in float roughness ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return BRDF_Lambert( rho );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float s = dot( lightDir, viewDir ) - dotNL * dotNV;
		float sOverT = ( s > 0.0 ) ? s / max( max( dotNL, dotNV ), EON_EPSILON ) : s;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		vec3 singleScatter = rho * RECIPROCAL_PI * A * ( 1.0 + roughness * sOverT );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		float albedoV = FON_DirectionalAlbedo( dotNV, roughness, A );
		float albedoL = FON_DirectionalAlbedo( dotNL, roughness, A );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		vec3 multiScatter = rhoMultiScatter * RECIPROCAL_PI
			* max( EON_EPSILON, 1.0 - albedoV )
			* max( EON_EPSILON, 1.0 - albedoL )
			/ max( EON_EPSILON, 1.0 - averageAlbedo );
		return singleScatter + multiScatter;
	}
	vec3 EON_DirectionalAlbedo( const in vec3 diffuseColor, const in float roughness, const in float dotNV ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return rho;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		float directionalAlbedo = FON_DirectionalAlbedo( dotNV, roughness, A );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		return rho * directionalAlbedo + rhoMultiScatter * ( 1.0 - directionalAlbedo );
	}
#endif
float V_GGX_SmithCorrelated( const in float alpha, const in float dotNL, const in float dotNV ) {
	float a2 = pow2( alpha );
	float gv = dotNL * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNV ) );
	float gl = dotNV * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNL ) );
	return 0.5 / max( gv + gl, EPSILON );
}
float D_GGX( const in float alpha, const in float dotNH ) {
	float a2 = pow2( alpha );
	float denom = pow2( dotNH ) * ( a2 - 1.0 ) + 1.0;
	return RECIPROCAL_PI * a2 / pow2( denom );
}
#ifdef USE_ANISOTROPY
	float V_GGX_SmithCorrelated_Anisotropic( const in float alphaT, const in float alphaB, const in float dotTV, const in float dotBV, const in float dotTL, const in float dotBL, const in float dotNV, const in float dotNL ) {
		float gv = dotNL * length( vec3( alphaT * dotTV, alphaB * dotBV, dotNV ) );
		float gl = dotNV * length( vec3( alphaT * dotTL, alphaB * dotBL, dotNL ) );
		return 0.5 / max( gv + gl, EPSILON );
	}
	float D_GGX_Anisotropic( const in float alphaT, const in float alphaB, const in float dotNH, const in float dotTH, const in float dotBH ) {
		float a2 = alphaT * alphaB;
		highp vec3 v = vec3( alphaB * dotTH, alphaT * dotBH, a2 * dotNH );
		highp float v2 = dot( v, v );
		float w2 = a2 / v2;
		return RECIPROCAL_PI * a2 * pow2 ( w2 );
	}
#endif
#ifdef USE_CLEARCOAT
	vec3 BRDF_GGX_Clearcoat( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material) {
		vec3 f0 = material.clearcoatF0;
		float f90 = material.clearcoatF90;
		float roughness = max( material.clearcoatRoughness, 0.045 );
		float alpha = pow2( roughness );
		vec3 halfDir = normalize( lightDir + viewDir );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float dotNH = saturate( dot( normal, halfDir ) );
		float dotVH = saturate( dot( viewDir, halfDir ) );
		vec3 F = F_Schlick( f0, f90, dotVH );
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
		return F * ( V * D );
	}
#endif
vec3 BRDF_GGX( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material ) {
	vec3 f0 = material.specularColorBlended;
	float f90 = material.specularF90;
	float roughness = max( material.roughness, 0.045 );
	float alpha = pow2( roughness );
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( f0, f90, dotVH );
	#ifdef USE_IRIDESCENCE
		F = mix( F, material.iridescenceFresnel, material.iridescence );
	#endif
	#ifdef USE_ANISOTROPY
		float dotTL = dot( material.anisotropyT, lightDir );
		float dotTV = dot( material.anisotropyT, viewDir );
		float dotTH = dot( material.anisotropyT, halfDir );
		float dotBL = dot( material.anisotropyB, lightDir );
		float dotBV = dot( material.anisotropyB, viewDir );
		float dotBH = dot( material.anisotropyB, halfDir );
		float alphaT = max( material.alphaT, alpha );
		float V = V_GGX_SmithCorrelated_Anisotropic( alphaT, alpha, dotTV, dotBV, dotTL, dotBL, dotNV, dotNL );
		float D = D_GGX_Anisotropic( alphaT, alpha, dotNH, dotTH, dotBH );
	#else
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
	#endif
	return F * ( V * D );
}
vec2 LTC_Uv( const in vec3 N, const in vec3 V, const in float roughness ) {
	const float LUT_SIZE = 64.0;
	const float LUT_SCALE = ( LUT_SIZE - 1.0 ) / LUT_SIZE;
	const float LUT_BIAS = 0.5 / LUT_SIZE;
	float dotNV = saturate( dot( N, V ) );
	vec2 uv = vec2( roughness, sqrt( 1.0 - dotNV ) );
	uv = uv * LUT_SCALE + LUT_BIAS;
	return uv;
}
float LTC_ClippedSphereFormFactor( const in vec3 f ) {
	float l = length( f );
	return max( ( l * l + f.z ) / ( l + 1.0 ), 0.0 );
}
vec3 LTC_EdgeVectorFormFactor( const in vec3 v1, const in vec3 v2 ) {
	float x = dot( v1, v2 );
	float y = abs( x );
	float a = 0.8543985 + ( 0.4965155 + 0.0145206 * y ) * y;
	float b = 3.4175940 + ( 4.1616724 + y ) * y;
	float v = a / b;
	float theta_sintheta = ( x > 0.0 ) ? v : 0.5 * inversesqrt( max( 1.0 - x * x, 1e-7 ) ) - v;
	return cross( v1, v2 ) * theta_sintheta;
}
vec3 LTC_Evaluate( const in vec3 N, const in vec3 V, const in vec3 P, const in mat3 mInv, const in vec3 rectCoords[ 4 ] ) {
	vec3 v1 = rectCoords[ 1 ] - rectCoords[ 0 ];
	vec3 v2 = rectCoords[ 3 ] - rectCoords[ 0 ];
	vec3 lightNormal = cross( v1, v2 );
	if( dot( lightNormal, P - rectCoords[ 0 ] ) < 0.0 ) return vec3( 0.0 );
	vec3 T1, T2;
	T1 = normalize( V - N * dot( V, N ) );
	T2 = - cross( N, T1 );
	mat3 mat = mInv * transpose( mat3( T1, T2, N ) );
	vec3 coords[ 4 ];
	coords[ 0 ] = mat * ( rectCoords[ 0 ] - P );
	coords[ 1 ] = mat * ( rectCoords[ 1 ] - P );
	coords[ 2 ] = mat * ( rectCoords[ 2 ] - P );
	coords[ 3 ] = mat * ( rectCoords[ 3 ] - P );
	coords[ 0 ] = normalize( coords[ 0 ] );
	coords[ 1 ] = normalize( coords[ 1 ] );
	coords[ 2 ] = normalize( coords[ 2 ] );
	coords[ 3 ] = normalize( coords[ 3 ] );
	vec3 vectorFormFactor = vec3( 0.0 );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 0 ], coords[ 1 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 1 ], coords[ 2 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 2 ], coords[ 3 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 3 ], coords[ 0 ] );
	float result = LTC_ClippedSphereFormFactor( vectorFormFactor );
	return vec3( result );
}
#if defined( USE_SHEEN )
float D_Charlie( float roughness, float dotNH ) {
	float alpha = pow2( roughness );
	float invAlpha = 1.0 / alpha;
	float cos2h = dotNH * dotNH;
	float sin2h = max( 1.0 - cos2h, 0.0078125 );
	return ( 2.0 + invAlpha ) * pow( sin2h, invAlpha * 0.5 ) / ( 2.0 * PI );
}
float V_Neubelt( float dotNV, float dotNL ) {
	return saturate( 1.0 / ( 4.0 * ( dotNL + dotNV - dotNL * dotNV ) ) );
}
vec3 BRDF_Sheen( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, vec3 sheenColor, const in float sheenRoughness ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float D = D_Charlie( sheenRoughness, dotNH );
	float V = V_Neubelt( dotNV, dotNL );
	return sheenColor * ( D * V );
}
#endif
float IBLSheenBRDF( const in vec3 normal, const in vec3 viewDir, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	float r2 = roughness * roughness;
	float rInv = 1.0 / ( roughness + 0.1 );
	float a = -1.9362 + 1.0678 * roughness + 0.4573 * r2 - 0.8469 * rInv;
	float b = -0.6014 + 0.5538 * roughness - 0.4670 * r2 - 0.1255 * rInv;
	float DG = exp( a * dotNV + b );
	return saturate( DG );
}
vec3 EnvironmentBRDF( const in vec3 normal, const in vec3 viewDir, const in vec3 specularColor, const in float specularF90, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	vec2 fab = texture2D( dfgLUT, vec2( roughness, dotNV ) ).rg;
	return specularColor * fab.x + specularF90 * fab.y;
}
#ifdef USE_IRIDESCENCE
void computeMultiscatteringIridescence( const in vec2 fab, const in vec3 specularColor, const in float specularF90, const in float iridescence, const in vec3 iridescenceF0, inout vec3 singleScatter, inout vec3 multiScatter ) {
#else
void computeMultiscattering( const in vec2 fab, const in vec3 specularColor, const in float specularF90, inout vec3 singleScatter, inout vec3 multiScatter ) {
#endif
	#ifdef USE_IRIDESCENCE
		vec3 Fr = mix( specularColor, iridescenceF0, iridescence );
	#else
		vec3 Fr = specularColor;
	#endif
	vec3 FssEss = Fr * fab.x + specularF90 * fab.y;
	float Ess = fab.x + fab.y;
	float Ems = 1.0 - Ess;
	vec3 Favg = Fr + ( 1.0 - Fr ) * 0.047619;	vec3 Fms = FssEss * Favg / ( 1.0 - Ems * Favg );
	singleScatter += FssEss;
	multiScatter += Fms * Ems;
}
#if NUM_RECT_AREA_LIGHTS > 0
	void RE_Direct_RectArea_Physical( const in RectAreaLight rectAreaLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
		vec3 normal = geometryNormal;
		vec3 viewDir = geometryViewDir;
		vec3 position = geometryPosition;
		vec3 lightPos = rectAreaLight.position;
		vec3 halfWidth = rectAreaLight.halfWidth;
		vec3 halfHeight = rectAreaLight.halfHeight;
		vec3 lightColor = rectAreaLight.color;
		float roughness = material.roughness;
		vec3 rectCoords[ 4 ];
		rectCoords[ 0 ] = lightPos + halfWidth - halfHeight;		rectCoords[ 1 ] = lightPos - halfWidth - halfHeight;
		rectCoords[ 2 ] = lightPos - halfWidth + halfHeight;
		rectCoords[ 3 ] = lightPos + halfWidth + halfHeight;
		vec2 uv = LTC_Uv( normal, viewDir, roughness );
		vec4 t1 = texture2D( ltc_1, uv );
		vec4 t2 = texture2D( ltc_2, uv );
		mat3 mInv = mat3(
			vec3( t1.x, 0, t1.y ),
			vec3(    0, 1,    0 ),
			vec3( t1.z, 0, t1.w )
		);
		vec3 fresnel = ( material.specularColorBlended * t2.x + ( material.specularF90 - material.specularColorBlended ) * t2.y );
		reflectedLight.directSpecular += lightColor * fresnel * LTC_Evaluate( normal, viewDir, position, mInv, rectCoords );
		reflectedLight.directDiffuse += lightColor * material.diffuseContribution * LTC_Evaluate( normal, viewDir, position, mat3( 1.0 ), rectCoords );
		#ifdef USE_CLEARCOAT
			vec3 Ncc = geometryClearcoatNormal;
			vec2 uvClearcoat = LTC_Uv( Ncc, viewDir, material.clearcoatRoughness );
			vec4 t1Clearcoat = texture2D( ltc_1, uvClearcoat );
			vec4 t2Clearcoat = texture2D( ltc_2, uvClearcoat );
			mat3 mInvClearcoat = mat3(
				vec3( t1Clearcoat.x, 0, t1Clearcoat.y ),
				vec3(             0, 1,             0 ),
				vec3( t1Clearcoat.z, 0, t1Clearcoat.w )
			);
			vec3 fresnelClearcoat = material.clearcoatF0 * t2Clearcoat.x + ( material.clearcoatF90 - material.clearcoatF0 ) * t2Clearcoat.y;
			clearcoatSpecularDirect += lightColor * fresnelClearcoat * LTC_Evaluate( Ncc, viewDir, position, mInvClearcoat, rectCoords );
		#endif
	}
#endif
void RE_Direct_Physical( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	#ifdef USE_CLEARCOAT
		float dotNLcc = saturate( dot( geometryClearcoatNormal, directLight.direction ) );
		vec3 ccIrradiance = dotNLcc * directLight.color;
		clearcoatSpecularDirect += ccIrradiance * BRDF_GGX_Clearcoat( directLight.direction, geometryViewDir, geometryClearcoatNormal, material );
	#endif
	#ifdef USE_SHEEN
 
 		sheenSpecularDirect += irradiance * BRDF_Sheen( directLight.direction, geometryViewDir, geometryNormal, material.sheenColor, material.sheenRoughness );
 
 		float sheenAlbedoV = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
 		float sheenAlbedoL = IBLSheenBRDF( geometryNormal, directLight.direction, material.sheenRoughness );
 
 		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * max( sheenAlbedoV, sheenAlbedoL );
 
 		irradiance *= sheenEnergyComp;
 
 	#endif
	vec3 specularBRDF = BRDF_GGX( directLight.direction, geometryViewDir, geometryNormal, material );
	#ifdef USE_RETROREFLECTION
		vec3 retroViewDir = reflect( - geometryViewDir, geometryNormal );
		vec3 retroSpecularBRDF = BRDF_GGX( directLight.direction, retroViewDir, geometryNormal, material );
		specularBRDF = mix( specularBRDF, retroSpecularBRDF, saturate( material.retroreflectivity ) );
	#endif
	reflectedLight.directSpecular += irradiance * specularBRDF * material.multiScatteringCompensation;
	vec3 halfDir = normalize( directLight.direction + geometryViewDir );
	float dotVH = saturate( dot( geometryViewDir, halfDir ) );
	vec3 F = F_Schlick( material.specularColor, material.specularF90, dotVH );
	#ifdef USE_RETROREFLECTION
		vec3 retroHalfDir = normalize( directLight.direction + retroViewDir );
		float dotRetroVH = saturate( dot( retroViewDir, retroHalfDir ) );
		vec3 retroF = F_Schlick( material.specularColor, material.specularF90, dotRetroVH );
		F = mix( F, retroF, saturate( material.retroreflectivity ) );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		vec3 diffuseBRDF = BRDF_EON( directLight.direction, geometryViewDir, geometryNormal, material.diffuseColor, material.diffuseRoughness ) * ( 1.0 - material.metalness );
	#else
		vec3 diffuseBRDF = BRDF_Lambert( material.diffuseContribution );
	#endif
	reflectedLight.directDiffuse += irradiance * diffuseBRDF * ( 1.0 - F );
}
void RE_IndirectDiffuse_Physical( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 singleScattering = vec3( 0.0 );
	vec3 multiScattering = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScattering, multiScattering );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScattering, multiScattering );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuseAlbedo = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness );
		vec3 diffuse = irradiance * RECIPROCAL_PI * diffuseAlbedo * ( 1.0 - singleScattering - multiScattering );
	#else
		vec3 diffuse = irradiance * BRDF_Lambert( material.diffuseContribution ) * ( 1.0 - singleScattering - multiScattering );
	#endif
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		sheenSpecularIndirect += irradiance * material.sheenColor * sheenAlbedo * RECIPROCAL_PI;
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		diffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectDiffuse += diffuse;
}
void RE_IndirectSpecular_Physical( const in vec3 radiance, const in vec3 irradiance, const in vec3 clearcoatRadiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
	#ifdef USE_CLEARCOAT
		clearcoatSpecularIndirect += clearcoatRadiance * EnvironmentBRDF( geometryClearcoatNormal, geometryViewDir, material.clearcoatF0, material.clearcoatF90, material.clearcoatRoughness );
	#endif
	#ifdef USE_SHEEN
		sheenSpecularIndirect += irradiance * material.sheenColor * IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness ) * RECIPROCAL_PI;
 	#endif
	vec3 singleScatteringDielectric = vec3( 0.0 );
	vec3 multiScatteringDielectric = vec3( 0.0 );
	vec3 singleScatteringMetallic = vec3( 0.0 );
	vec3 multiScatteringMetallic = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscatteringIridescence( material.dfg, material.diffuseColor, material.specularF90, material.iridescence, material.iridescenceF0Metallic, singleScatteringMetallic, multiScatteringMetallic );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscattering( material.dfg, material.diffuseColor, material.specularF90, singleScatteringMetallic, multiScatteringMetallic );
	#endif
	vec3 singleScattering = mix( singleScatteringDielectric, singleScatteringMetallic, material.metalness );
	vec3 multiScattering = mix( multiScatteringDielectric, multiScatteringMetallic, material.metalness );
	vec3 totalScatteringDielectric = singleScatteringDielectric + multiScatteringDielectric;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuse = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness ) * ( 1.0 - totalScatteringDielectric );
	#else
		vec3 diffuse = material.diffuseContribution * ( 1.0 - totalScatteringDielectric );
	#endif
	vec3 cosineWeightedIrradiance = irradiance * RECIPROCAL_PI;
	vec3 indirectSpecular = radiance * singleScattering;
	indirectSpecular += multiScattering * cosineWeightedIrradiance;
	vec3 indirectDiffuse = diffuse * cosineWeightedIrradiance;
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		indirectSpecular *= sheenEnergyComp;
		indirectDiffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectSpecular += indirectSpecular;
	reflectedLight.indirectDiffuse += indirectDiffuse;
}
#define RE_Direct				RE_Direct_Physical
#define RE_Direct_RectArea		RE_Direct_RectArea_Physical
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Physical
#define RE_IndirectSpecular		RE_IndirectSpecular_Physical
float computeSpecularOcclusion( const in float dotNV, const in float ambientOcclusion, const in float roughness ) {
	return saturate( pow( dotNV + ambientOcclusion, exp2( - 16.0 * roughness - 1.0 ) ) - 1.0 + ambientOcclusion );
}`,VC=`
vec3 geometryPosition = - vViewPosition;
vec3 geometryNormal = normal;
vec3 geometryViewDir = ( isOrthographic ) ? vec3( 0, 0, 1 ) : normalize( vViewPosition );
vec3 geometryClearcoatNormal = vec3( 0.0 );
#ifdef USE_CLEARCOAT
	geometryClearcoatNormal = clearcoatNormal;
#endif
#ifdef USE_IRIDESCENCE
	float dotNVi = saturate( dot( normal, geometryViewDir ) );
	if ( material.iridescenceThickness == 0.0 ) {
		material.iridescence = 0.0;
	} else {
		material.iridescence = saturate( material.iridescence );
	}
	if ( material.iridescence > 0.0 ) {
		vec3 iridescenceFresnelDielectric = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.specularColor );
		vec3 iridescenceFresnelMetallic = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.diffuseColor );
		material.iridescenceFresnel = mix( iridescenceFresnelDielectric, iridescenceFresnelMetallic, material.metalness );
		material.iridescenceF0Dielectric = Schlick_to_F0( iridescenceFresnelDielectric, 1.0, dotNVi );
		material.iridescenceF0Metallic = Schlick_to_F0( iridescenceFresnelMetallic, 1.0, dotNVi );
	}
#endif
#ifdef STANDARD
	float dotNVms = saturate( dot( geometryNormal, geometryViewDir ) );
	material.dfg = texture2D( dfgLUT, vec2( material.roughness, dotNVms ) ).rg;
	#if ( NUM_SUN_LIGHTS > 0 || NUM_DIR_LIGHTS > 0 || NUM_POINT_LIGHTS > 0 || NUM_SPOT_LIGHTS > 0 )
		float EssMs = material.dfg.x + material.dfg.y;
		material.multiScatteringCompensation = 1.0 + material.specularColorBlended * ( 1.0 / EssMs - 1.0 );
	#endif
#endif
IncidentLight directLight;
#if ( NUM_POINT_LIGHTS > 0 ) && defined( RE_Direct )
	PointLight pointLight;
	#if defined( USE_SHADOWMAP ) && NUM_POINT_LIGHT_SHADOWS > 0
	PointLightShadow pointLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHTS; i ++ ) {
		pointLight = pointLights[ i ];
		getPointLightInfo( pointLight, geometryPosition, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_POINT_LIGHT_SHADOWS ) && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
		pointLightShadow = pointLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getPointShadow( pointShadowMap[ i ], pointLightShadow.shadowMapSize, pointLightShadow.shadowIntensity, pointLightShadow.shadowBias, pointLightShadow.shadowRadius, vPointShadowCoord[ i ], pointLightShadow.shadowCameraNear, pointLightShadow.shadowCameraFar ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SPOT_LIGHTS > 0 ) && defined( RE_Direct )
	SpotLight spotLight;
	vec4 spotColor;
	vec3 spotLightCoord;
	bool inSpotLightMap;
	#if defined( USE_SHADOWMAP ) && NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHTS; i ++ ) {
		spotLight = spotLights[ i ];
		getSpotLightInfo( spotLight, geometryPosition, directLight );
		#if ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#define SPOT_LIGHT_MAP_INDEX UNROLLED_LOOP_INDEX
		#elif ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		#define SPOT_LIGHT_MAP_INDEX NUM_SPOT_LIGHT_MAPS
		#else
		#define SPOT_LIGHT_MAP_INDEX ( UNROLLED_LOOP_INDEX - NUM_SPOT_LIGHT_SHADOWS + NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#endif
		#if ( SPOT_LIGHT_MAP_INDEX < NUM_SPOT_LIGHT_MAPS )
			spotLightCoord = vSpotLightCoord[ i ].xyz / vSpotLightCoord[ i ].w;
			inSpotLightMap = all( lessThan( abs( spotLightCoord * 2. - 1. ), vec3( 1.0 ) ) );
			spotColor = texture2D( spotLightMap[ SPOT_LIGHT_MAP_INDEX ], spotLightCoord.xy );
			directLight.color = inSpotLightMap ? directLight.color * spotColor.rgb : directLight.color;
		#endif
		#undef SPOT_LIGHT_MAP_INDEX
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		spotLightShadow = spotLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( spotShadowMap[ i ], spotLightShadow.shadowMapSize, spotLightShadow.shadowIntensity, spotLightShadow.shadowBias, spotLightShadow.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SUN_LIGHTS > 0 ) && defined( RE_Direct )
	SunLight sunLight;
	#if defined( USE_SHADOWMAP ) && NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHTS; i ++ ) {
		sunLight = sunLights[ i ];
		getSunLightInfo( sunLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SUN_LIGHT_SHADOWS )
		sunLightShadow = sunLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getSunShadow( sunShadowMap[ i ], sunLightShadow, UNROLLED_LOOP_INDEX ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_DIR_LIGHTS > 0 ) && defined( RE_Direct )
	DirectionalLight directionalLight;
	#if defined( USE_SHADOWMAP ) && NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHTS; i ++ ) {
		directionalLight = directionalLights[ i ];
		getDirectionalLightInfo( directionalLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_DIR_LIGHT_SHADOWS )
		directionalLightShadow = directionalLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( directionalShadowMap[ i ], directionalLightShadow.shadowMapSize, directionalLightShadow.shadowIntensity, directionalLightShadow.shadowBias, directionalLightShadow.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_RECT_AREA_LIGHTS > 0 ) && defined( RE_Direct_RectArea )
	RectAreaLight rectAreaLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_RECT_AREA_LIGHTS; i ++ ) {
		rectAreaLight = rectAreaLights[ i ];
		RE_Direct_RectArea( rectAreaLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if defined( RE_IndirectDiffuse )
	vec3 iblIrradiance = vec3( 0.0 );
	vec3 irradiance = getAmbientLightIrradiance( ambientLightColor );
	#if defined( USE_LIGHT_PROBES )
		irradiance += getLightProbeIrradiance( lightProbe, geometryNormal );
	#endif
	#if ( NUM_HEMI_LIGHTS > 0 )
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_HEMI_LIGHTS; i ++ ) {
			irradiance += getHemisphereLightIrradiance( hemisphereLights[ i ], geometryNormal );
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_LIGHT_PROBE_GRIDS > 0
		vec3 probeWorldPos = ( ( vec4( geometryPosition, 1.0 ) - viewMatrix[ 3 ] ) * viewMatrix ).xyz;
		vec3 probeWorldNormal = transformNormalByInverseViewMatrix( geometryNormal, viewMatrix );
		int probeGrid = - 1;
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( isInsideLightProbeGrid( probeWorldPos, probeWorldNormal, probesMin[ i ], probesMax[ i ], probesResolution[ i ] ) ) probeGrid = UNROLLED_LOOP_INDEX;
		}
		#pragma unroll_loop_end
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( probeGrid == UNROLLED_LOOP_INDEX ) irradiance += getLightProbeGridIrradiance( probesSH[ i ], probesMin[ i ], probesMax[ i ], probesResolution[ i ], probeWorldPos, probeWorldNormal );
		}
		#pragma unroll_loop_end
	#endif
#endif
#if defined( RE_IndirectSpecular )
	vec3 radiance = vec3( 0.0 );
	vec3 clearcoatRadiance = vec3( 0.0 );
#endif`,HC=`#if defined( RE_IndirectDiffuse )
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		vec3 lightMapIrradiance = lightMapTexel.rgb * lightMapIntensity;
		irradiance += lightMapIrradiance;
	#endif
	#if defined( USE_ENVMAP ) && defined( ENVMAP_TYPE_PMREM )
		#if defined( STANDARD ) || defined( LAMBERT ) || defined( PHONG )
			iblIrradiance += getIBLIrradiance( geometryNormal );
		#endif
	#endif
#endif
#if defined( USE_ENVMAP ) && defined( RE_IndirectSpecular )
	#ifdef USE_ANISOTROPY
		vec3 iblRadiance = getIBLAnisotropyRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
	#else
		vec3 iblRadiance = getIBLRadiance( geometryViewDir, geometryNormal, material.roughness );
	#endif
	#ifdef USE_RETROREFLECTION
		#ifdef USE_ANISOTROPY
			vec3 retroIBLRadiance = getIBLAnisotropyRetroRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
		#else
			vec3 retroIBLRadiance = getIBLRetroRadiance( geometryViewDir, geometryNormal, material.roughness );
		#endif
		iblRadiance = mix( iblRadiance, retroIBLRadiance, saturate( material.retroreflectivity ) );
	#endif
	radiance += iblRadiance;
	#ifdef USE_CLEARCOAT
		clearcoatRadiance += getIBLRadiance( geometryViewDir, geometryClearcoatNormal, material.clearcoatRoughness );
	#endif
#endif`,GC=`#if defined( RE_IndirectDiffuse )
	#if defined( LAMBERT ) || defined( PHONG )
		irradiance += iblIrradiance;
	#endif
	RE_IndirectDiffuse( irradiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif
#if defined( RE_IndirectSpecular )
	RE_IndirectSpecular( radiance, iblIrradiance, clearcoatRadiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif`,WC=`#if NUM_LIGHT_PROBE_GRIDS > 0
uniform highp sampler3D probesSH[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMin[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMax[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesResolution[ NUM_LIGHT_PROBE_GRIDS ];
bool isInsideLightProbeGrid( vec3 worldPos, vec3 worldNormal, vec3 probesMin, vec3 probesMax, vec3 probesResolution ) {
	vec3 spacing = ( probesMax - probesMin ) / probesResolution;
	vec3 samplePos = worldPos + worldNormal * spacing * 0.5;
	vec3 margin = spacing * 0.01;
	return all( greaterThanEqual( samplePos, probesMin - margin ) ) && all( lessThanEqual( samplePos, probesMax + margin ) );
}
vec3 getLightProbeGridIrradiance( highp sampler3D probesSH, vec3 probesMin, vec3 probesMax, vec3 probesResolution, vec3 worldPos, vec3 worldNormal ) {
	vec3 res = probesResolution;
	vec3 gridRange = probesMax - probesMin;
	vec3 probeSpacing = gridRange / res;
	vec3 samplePos = worldPos + worldNormal * probeSpacing * 0.5;
	vec3 uvw = clamp( ( samplePos - probesMin ) / gridRange, 0.5 / res, 1.0 - 0.5 / res );
	float nz          = res.z;
	float paddedSlices = nz + 2.0;
	float atlasDepth  = 7.0 * paddedSlices;
	float uvZBase     = uvw.z * nz + 1.0;
	vec4 s0 = texture( probesSH, vec3( uvw.xy, ( uvZBase                       ) / atlasDepth ) );
	vec4 s1 = texture( probesSH, vec3( uvw.xy, ( uvZBase +       paddedSlices   ) / atlasDepth ) );
	vec4 s2 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 2.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s3 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 3.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s4 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 4.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s5 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 5.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s6 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 6.0 * paddedSlices   ) / atlasDepth ) );
	vec3 c0 = s0.xyz;
	vec3 c1 = vec3( s0.w, s1.xy );
	vec3 c2 = vec3( s1.zw, s2.x );
	vec3 c3 = s2.yzw;
	vec3 c4 = s3.xyz;
	vec3 c5 = vec3( s3.w, s4.xy );
	vec3 c6 = vec3( s4.zw, s5.x );
	vec3 c7 = s5.yzw;
	vec3 c8 = s6.xyz;
	float x = worldNormal.x, y = worldNormal.y, z = worldNormal.z;
	vec3 result = c0 * 0.886227;
	result += c1 * 2.0 * 0.511664 * y;
	result += c2 * 2.0 * 0.511664 * z;
	result += c3 * 2.0 * 0.511664 * x;
	result += c4 * 2.0 * 0.429043 * x * y;
	result += c5 * 2.0 * 0.429043 * y * z;
	result += c6 * ( 0.743125 * z * z - 0.247708 );
	result += c7 * 2.0 * 0.429043 * x * z;
	result += c8 * 0.429043 * ( x * x - y * y );
	return max( result, vec3( 0.0 ) );
}
#endif`,qC=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	gl_FragDepth = vIsPerspective == 0.0 ? gl_FragCoord.z : log2( vFragDepth ) * logDepthBufFC * 0.5;
#endif`,XC=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	uniform float logDepthBufFC;
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,$C=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,YC=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	vFragDepth = 1.0 + gl_Position.w;
	vIsPerspective = float( isPerspectiveMatrix( projectionMatrix ) );
#endif`,KC=`#ifdef USE_MAP
	vec4 sampledDiffuseColor = texture2D( map, vMapUv );
	#ifdef DECODE_VIDEO_TEXTURE
		sampledDiffuseColor = sRGBTransferEOTF( sampledDiffuseColor );
	#endif
	diffuseColor *= sampledDiffuseColor;
#endif`,JC=`#ifdef USE_MAP
	uniform sampler2D map;
#endif`,ZC=`#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
	#if defined( USE_POINTS_UV )
		vec2 uv = vUv;
	#else
		vec2 uv = ( uvTransform * vec3( gl_PointCoord.x, 1.0 - gl_PointCoord.y, 1 ) ).xy;
	#endif
#endif
#ifdef USE_MAP
	diffuseColor *= texture2D( map, uv );
#endif
#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, uv ).g;
#endif`,jC=`#if defined( USE_POINTS_UV )
	varying vec2 vUv;
#else
	#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
		uniform mat3 uvTransform;
	#endif
#endif
#ifdef USE_MAP
	uniform sampler2D map;
#endif
#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,QC=`float metalnessFactor = metalness;
#ifdef USE_METALNESSMAP
	vec4 texelMetalness = texture2D( metalnessMap, vMetalnessMapUv );
	metalnessFactor *= texelMetalness.b;
#endif`,eR=`#ifdef USE_METALNESSMAP
	uniform sampler2D metalnessMap;
#endif`,tR=`#ifdef USE_INSTANCING_MORPH
	float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	float morphTargetBaseInfluence = texelFetch( morphTexture, ivec2( 0, gl_InstanceID ), 0 ).r;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		morphTargetInfluences[i] =  texelFetch( morphTexture, ivec2( i + 1, gl_InstanceID ), 0 ).r;
	}
#endif`,iR=`#if defined( USE_MORPHCOLORS )
	#if defined( USE_COLOR_ALPHA )
		vColor *= morphTargetBaseInfluence;
	#elif defined( USE_COLOR )
		vColor.rgb *= morphTargetBaseInfluence;
	#endif
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		#if defined( USE_COLOR_ALPHA )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor += getMorph( gl_VertexID, i, 2 ) * morphTargetInfluences[ i ];
		#elif defined( USE_COLOR )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor.rgb += getMorph( gl_VertexID, i, 2 ).rgb * morphTargetInfluences[ i ];
		#endif
	}
#endif`,nR=`#ifdef USE_MORPHNORMALS
	objectNormal *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) objectNormal += getMorph( gl_VertexID, i, 1 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,sR=`#ifdef USE_MORPHTARGETS
	#ifndef USE_INSTANCING_MORPH
		uniform float morphTargetBaseInfluence;
		uniform float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	#endif
	uniform sampler2DArray morphTargetsTexture;
	uniform ivec2 morphTargetsTextureSize;
	vec4 getMorph( const in int vertexIndex, const in int morphTargetIndex, const in int offset ) {
		int texelIndex = vertexIndex * MORPHTARGETS_TEXTURE_STRIDE + offset;
		int y = texelIndex / morphTargetsTextureSize.x;
		int x = texelIndex - y * morphTargetsTextureSize.x;
		ivec3 morphUV = ivec3( x, y, morphTargetIndex );
		return texelFetch( morphTargetsTexture, morphUV, 0 );
	}
#endif`,rR=`#ifdef USE_MORPHTARGETS
	transformed *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) transformed += getMorph( gl_VertexID, i, 0 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,oR=`float faceDirection = gl_FrontFacing ? 1.0 : - 1.0;
#ifdef FLAT_SHADED
	vec3 fdx = dFdx( vViewPosition );
	vec3 fdy = dFdy( vViewPosition );
	vec3 normal = normalize( cross( fdx, fdy ) );
#else
	vec3 normal = normalize( vNormal );
	#ifdef DOUBLE_SIDED
		normal *= faceDirection;
	#endif
#endif
#if defined( USE_NORMALMAP_TANGENTSPACE ) || defined( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY )
	#ifdef USE_TANGENT
		mat3 tbn = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn = getTangentFrame( - vViewPosition, normal,
		#if defined( USE_NORMALMAP )
			vNormalMapUv
		#elif defined( USE_CLEARCOAT_NORMALMAP )
			vClearcoatNormalMapUv
		#else
			vUv
		#endif
		);
	#endif
	#ifdef DOUBLE_SIDED
		tbn[0] *= faceDirection;
		tbn[1] *= faceDirection;
	#endif
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	#ifdef USE_TANGENT
		mat3 tbn2 = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn2 = getTangentFrame( - vViewPosition, normal, vClearcoatNormalMapUv );
	#endif
	#ifdef DOUBLE_SIDED
		tbn2[0] *= faceDirection;
		tbn2[1] *= faceDirection;
	#endif
#endif
vec3 nonPerturbedNormal = normal;`,aR=`#ifdef USE_NORMALMAP_OBJECTSPACE
	normal = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#ifdef FLIP_SIDED
		normal = - normal;
	#endif
	#ifdef DOUBLE_SIDED
		normal = normal * faceDirection;
	#endif
	normal = normalize( normalMatrix * normal );
#elif defined( USE_NORMALMAP_TANGENTSPACE )
	vec3 mapN = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#if defined( USE_PACKED_NORMALMAP )
		mapN = vec3( mapN.xy, sqrt( saturate( 1.0 - dot( mapN.xy, mapN.xy ) ) ) );
	#endif
	mapN.xy *= normalScale;
	normal = normalize( tbn * mapN );
#elif defined( USE_BUMPMAP )
	normal = perturbNormalArb( - vViewPosition, normal, dHdxy_fwd(), faceDirection );
#endif`,lR=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,cR=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,hR=`#ifndef FLAT_SHADED
	vNormal = normalize( transformedNormal );
	#ifdef USE_TANGENT
		vTangent = normalize( transformedTangent );
		vBitangent = normalize( cross( vNormal, vTangent ) * tangent.w );
		#ifdef FLIP_SIDED
			vBitangent = - vBitangent;
		#endif
	#endif
#endif`,uR=`#ifdef USE_NORMALMAP
	uniform sampler2D normalMap;
	uniform vec2 normalScale;
#endif
#ifdef USE_NORMALMAP_OBJECTSPACE
	uniform mat3 normalMatrix;
#endif
#if ! defined ( USE_TANGENT ) && ( defined ( USE_NORMALMAP_TANGENTSPACE ) || defined ( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY ) )
	mat3 getTangentFrame( vec3 eye_pos, vec3 surf_norm, vec2 uv ) {
		vec3 q0 = dFdx( eye_pos.xyz );
		vec3 q1 = dFdy( eye_pos.xyz );
		vec2 st0 = dFdx( uv.st );
		vec2 st1 = dFdy( uv.st );
		vec3 N = surf_norm;
		vec3 q1perp = cross( q1, N );
		vec3 q0perp = cross( N, q0 );
		vec3 T = q1perp * st0.x + q0perp * st1.x;
		vec3 B = q1perp * st0.y + q0perp * st1.y;
		float det = max( dot( T, T ), dot( B, B ) );
		float scale = ( det == 0.0 ) ? 0.0 : inversesqrt( det );
		return mat3( T * scale, B * scale, N );
	}
#endif`,fR=`#ifdef USE_CLEARCOAT
	vec3 clearcoatNormal = nonPerturbedNormal;
#endif`,dR=`#ifdef USE_CLEARCOAT_NORMALMAP
	vec3 clearcoatMapN = texture2D( clearcoatNormalMap, vClearcoatNormalMapUv ).xyz * 2.0 - 1.0;
	clearcoatMapN.xy *= clearcoatNormalScale;
	clearcoatNormal = normalize( tbn2 * clearcoatMapN );
#endif`,pR=`#ifdef USE_CLEARCOATMAP
	uniform sampler2D clearcoatMap;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform sampler2D clearcoatNormalMap;
	uniform vec2 clearcoatNormalScale;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform sampler2D clearcoatRoughnessMap;
#endif`,mR=`#ifdef USE_IRIDESCENCEMAP
	uniform sampler2D iridescenceMap;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform sampler2D iridescenceThicknessMap;
#endif`,gR=`#ifdef OPAQUE
diffuseColor.a = 1.0;
#endif
#ifdef USE_TRANSMISSION
diffuseColor.a *= material.transmissionAlpha;
#endif
gl_FragColor = vec4( outgoingLight, diffuseColor.a );`,xR=`vec3 packNormalToRGB( const in vec3 normal ) {
	return normalize( normal ) * 0.5 + 0.5;
}
vec3 unpackRGBToNormal( const in vec3 rgb ) {
	return 2.0 * rgb.xyz - 1.0;
}
const float PackUpscale = 256. / 255.;const float UnpackDownscale = 255. / 256.;const float ShiftRight8 = 1. / 256.;
const float Inv255 = 1. / 255.;
const vec4 PackFactors = vec4( 1.0, 256.0, 256.0 * 256.0, 256.0 * 256.0 * 256.0 );
const vec2 UnpackFactors2 = vec2( UnpackDownscale, 1.0 / PackFactors.g );
const vec3 UnpackFactors3 = vec3( UnpackDownscale / PackFactors.rg, 1.0 / PackFactors.b );
const vec4 UnpackFactors4 = vec4( UnpackDownscale / PackFactors.rgb, 1.0 / PackFactors.a );
vec4 packDepthToRGBA( const in float v ) {
	if( v <= 0.0 )
		return vec4( 0., 0., 0., 0. );
	if( v >= 1.0 )
		return vec4( 1., 1., 1., 1. );
	float vuf;
	float af = modf( v * PackFactors.a, vuf );
	float bf = modf( vuf * ShiftRight8, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec4( vuf * Inv255, gf * PackUpscale, bf * PackUpscale, af );
}
vec3 packDepthToRGB( const in float v ) {
	if( v <= 0.0 )
		return vec3( 0., 0., 0. );
	if( v >= 1.0 )
		return vec3( 1., 1., 1. );
	float vuf;
	float bf = modf( v * PackFactors.b, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec3( vuf * Inv255, gf * PackUpscale, bf );
}
vec2 packDepthToRG( const in float v ) {
	if( v <= 0.0 )
		return vec2( 0., 0. );
	if( v >= 1.0 )
		return vec2( 1., 1. );
	float vuf;
	float gf = modf( v * 256., vuf );
	return vec2( vuf * Inv255, gf );
}
float unpackRGBAToDepth( const in vec4 v ) {
	return dot( v, UnpackFactors4 );
}
float unpackRGBToDepth( const in vec3 v ) {
	return dot( v, UnpackFactors3 );
}
float unpackRGToDepth( const in vec2 v ) {
	return v.r * UnpackFactors2.r + v.g * UnpackFactors2.g;
}
vec4 pack2HalfToRGBA( const in vec2 v ) {
	vec4 r = vec4( v.x, fract( v.x * 255.0 ), v.y, fract( v.y * 255.0 ) );
	return vec4( r.x - r.y / 255.0, r.y, r.z - r.w / 255.0, r.w );
}
vec2 unpackRGBATo2Half( const in vec4 v ) {
	return vec2( v.x + ( v.y / 255.0 ), v.z + ( v.w / 255.0 ) );
}
float viewZToOrthographicDepth( const in float viewZ, const in float near, const in float far ) {
	return ( viewZ + near ) / ( near - far );
}
float orthographicDepthToViewZ( const in float depth, const in float near, const in float far ) {
	#ifdef USE_REVERSED_DEPTH_BUFFER
	
		return depth * ( far - near ) - far;
	#else
		return depth * ( near - far ) - near;
	#endif
}
float viewZToPerspectiveDepth( const in float viewZ, const in float near, const in float far ) {
	return ( ( near + viewZ ) * far ) / ( ( far - near ) * viewZ );
}
float perspectiveDepthToViewZ( const in float depth, const in float near, const in float far ) {
	
	#ifdef USE_REVERSED_DEPTH_BUFFER
		return ( near * far ) / ( ( near - far ) * depth - near );
	#else
		return ( near * far ) / ( ( far - near ) * depth - far );
	#endif
}`,vR=`#ifdef PREMULTIPLIED_ALPHA
	gl_FragColor.rgb *= gl_FragColor.a;
#endif`,yR=`vec4 mvPosition = vec4( transformed, 1.0 );
#ifdef USE_BATCHING
	mvPosition = batchingMatrix * mvPosition;
#endif
#ifdef USE_INSTANCING
	mvPosition = instanceMatrix * mvPosition;
#endif
mvPosition = modelViewMatrix * mvPosition;
gl_Position = projectionMatrix * mvPosition;`,bR=`#ifdef DITHERING
	gl_FragColor.rgb = dithering( gl_FragColor.rgb );
#endif`,_R=`#ifdef DITHERING
	vec3 dithering( vec3 color ) {
		float grid_position = rand( gl_FragCoord.xy );
		vec3 dither_shift_RGB = vec3( 0.25 / 255.0, -0.25 / 255.0, 0.25 / 255.0 );
		dither_shift_RGB = mix( 2.0 * dither_shift_RGB, -2.0 * dither_shift_RGB, grid_position );
		return color + dither_shift_RGB;
	}
#endif`,SR=`float roughnessFactor = roughness;
#ifdef USE_ROUGHNESSMAP
	vec4 texelRoughness = texture2D( roughnessMap, vRoughnessMapUv );
	roughnessFactor *= texelRoughness.g;
#endif`,wR=`#ifdef USE_ROUGHNESSMAP
	uniform sampler2D roughnessMap;
#endif`,MR=`#if NUM_SPOT_LIGHT_COORDS > 0
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#if NUM_SPOT_LIGHT_MAPS > 0
	uniform sampler2D spotLightMap[ NUM_SPOT_LIGHT_MAPS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		#define SUN_LIGHT_CASCADES 2
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#else
			uniform sampler2D sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#endif
		uniform mat4 sunShadowMatrix[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		uniform vec4 sunShadowCascade[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
		struct SunLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SunLightShadow sunLightShadows[ NUM_SUN_LIGHT_SHADOWS ];
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#else
			uniform sampler2D directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#endif
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#else
			uniform sampler2D spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#endif
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform samplerCubeShadow pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#elif defined( SHADOWMAP_TYPE_BASIC )
			uniform samplerCube pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#endif
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float interleavedGradientNoise( vec2 position ) {
			return fract( 52.9829189 * fract( dot( position, vec2( 0.06711056, 0.00583715 ) ) ) );
		}
		vec2 vogelDiskSample( int sampleIndex, int samplesCount, float phi ) {
			const float goldenAngle = 2.399963229728653;
			float r = sqrt( ( float( sampleIndex ) + 0.5 ) / float( samplesCount ) );
			float theta = float( sampleIndex ) * goldenAngle + phi;
			return vec2( cos( theta ), sin( theta ) ) * r;
		}
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float getShadow( sampler2DShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 texelSize = vec2( 1.0 ) / shadowMapSize;
				vec2 radius = shadowRadius * texelSize;
				float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
				shadow = (
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 0, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 1, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 2, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 3, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 4, 5, phi ) * radius, shadowCoord.z ) )
				) * 0.2;
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#elif defined( SHADOWMAP_TYPE_VSM )
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 distribution = texture2D( shadowMap, shadowCoord.xy ).rg;
				float mean = distribution.x;
				float variance = distribution.y * distribution.y;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					float hard_shadow = step( mean, shadowCoord.z );
				#else
					float hard_shadow = step( shadowCoord.z, mean );
				#endif
				
				if ( hard_shadow == 1.0 ) {
					shadow = 1.0;
				} else {
					variance = max( variance, 0.0000001 );
					float d = shadowCoord.z - mean;
					float p_max = variance / ( variance + d * d );
					p_max = clamp( ( p_max - 0.3 ) / 0.65, 0.0, 1.0 );
					shadow = max( hard_shadow, p_max );
				}
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#else
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				float depth = texture2D( shadowMap, shadowCoord.xy ).r;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					shadow = step( depth, shadowCoord.z );
				#else
					shadow = step( shadowCoord.z, depth );
				#endif
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#endif
	#if NUM_SUN_LIGHT_SHADOWS > 0
		float getSunShadow(
			#if defined( SHADOWMAP_TYPE_PCF )
				sampler2DShadow shadowMap,
			#else
				sampler2D shadowMap,
			#endif
			SunLightShadow sunLightShadow,
			int shadowIndex
		) {
			vec4 shadowWorldPosition = vec4( vSunShadowWorldPosition.xyz + vSunShadowWorldNormal * sunLightShadow.shadowNormalBias, 1.0 );
			float viewDepth = vSunShadowWorldPosition.w;
			int cascadeOffset = shadowIndex * SUN_LIGHT_CASCADES;
			float shadow = 1.0;
			for ( int i = SUN_LIGHT_CASCADES - 1; i >= 0; i -- ) {
				vec4 cascade = sunShadowCascade[ cascadeOffset + i ];
				if ( viewDepth >= cascade.x && viewDepth < cascade.y ) {
					float cascadeShadow = getShadow(
						shadowMap,
						sunLightShadow.shadowMapSize,
						sunLightShadow.shadowIntensity,
						sunLightShadow.shadowBias,
						sunLightShadow.shadowRadius,
						sunShadowMatrix[ cascadeOffset + i ] * shadowWorldPosition
					);
					shadow = mix( cascadeShadow, shadow, smoothstep( cascade.z, cascade.y, viewDepth ) );
				}
			}
			return shadow;
		}
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
	#if defined( SHADOWMAP_TYPE_PCF )
	float getPointShadow( samplerCubeShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 bd3D = normalize( lightToPosition );
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float lightDistance = length( lightToPosition );
			float depthRange = shadowCameraFar - shadowCameraNear;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				float depthA = - shadowCameraNear / depthRange - shadowBias;
				float depthB = shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#else
				float depthA = shadowCameraFar / depthRange + shadowBias;
				float depthB = - shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#endif
			float texelSize = shadowRadius / shadowMapSize.x;
			vec3 absDir = abs( bd3D );
			vec3 tangent = absDir.x > absDir.z ? vec3( 0.0, 1.0, 0.0 ) : vec3( 1.0, 0.0, 0.0 );
			tangent = normalize( cross( bd3D, tangent ) );
			vec3 bitangent = cross( bd3D, tangent );
			float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
			shadow = 0.0;
			for ( int i = 0; i < 5; i ++ ) {
				vec2 offset = vogelDiskSample( i, 5, phi );
				vec3 direction = bd3D + ( tangent * offset.x + bitangent * offset.y ) * texelSize;
				vec3 absDirection = abs( direction );
				float dp = depthA + depthB / max( max( absDirection.x, absDirection.y ), absDirection.z );
				shadow += texture( shadowMap, vec4( direction, dp ) );
			}
			shadow *= 0.2;
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#elif defined( SHADOWMAP_TYPE_BASIC )
	float getPointShadow( samplerCube shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float dp = ( shadowCameraFar * ( viewSpaceZ - shadowCameraNear ) ) / ( viewSpaceZ * ( shadowCameraFar - shadowCameraNear ) );
			dp += shadowBias;
			vec3 bd3D = normalize( lightToPosition );
			float depth = textureCube( shadowMap, bd3D ).r;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				depth = 1.0 - depth;
			#endif
			shadow = step( dp, depth );
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#endif
	#endif
#endif`,AR=`#if NUM_SPOT_LIGHT_COORDS > 0
	uniform mat4 spotLightMatrix[ NUM_SPOT_LIGHT_COORDS ];
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		uniform mat4 directionalShadowMatrix[ NUM_DIR_LIGHT_SHADOWS ];
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		uniform mat4 pointShadowMatrix[ NUM_POINT_LIGHT_SHADOWS ];
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
#endif`,TR=`#if ( defined( USE_SHADOWMAP ) && ( NUM_DIR_LIGHT_SHADOWS > 0 || NUM_SUN_LIGHT_SHADOWS > 0 || NUM_POINT_LIGHT_SHADOWS > 0 ) ) || ( NUM_SPOT_LIGHT_COORDS > 0 )
	#ifdef HAS_NORMAL
		vec3 shadowWorldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
	#else
		vec3 shadowWorldNormal = vec3( 0.0 );
	#endif
	vec4 shadowWorldPosition;
#endif
#if defined( USE_SHADOWMAP )
	#if NUM_SUN_LIGHT_SHADOWS > 0
		vSunShadowWorldPosition = vec4( worldPosition.xyz, - mvPosition.z );
		vSunShadowWorldNormal = shadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * directionalLightShadows[ i ].shadowNormalBias, 0 );
			vDirectionalShadowCoord[ i ] = directionalShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * pointLightShadows[ i ].shadowNormalBias, 0 );
			vPointShadowCoord[ i ] = pointShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
#endif
#if NUM_SPOT_LIGHT_COORDS > 0
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_COORDS; i ++ ) {
		shadowWorldPosition = worldPosition;
		#if ( defined( USE_SHADOWMAP ) && UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
			shadowWorldPosition.xyz += shadowWorldNormal * spotLightShadows[ i ].shadowNormalBias;
		#endif
		vSpotLightCoord[ i ] = spotLightMatrix[ i ] * shadowWorldPosition;
	}
	#pragma unroll_loop_end
#endif`,ER=`float getShadowMask() {
	float shadow = 1.0;
	#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHT_SHADOWS; i ++ ) {
		sunLight = sunLightShadows[ i ];
		shadow *= receiveShadow ? getSunShadow( sunShadowMap[ i ], sunLight, UNROLLED_LOOP_INDEX ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
		directionalLight = directionalLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( directionalShadowMap[ i ], directionalLight.shadowMapSize, directionalLight.shadowIntensity, directionalLight.shadowBias, directionalLight.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_SHADOWS; i ++ ) {
		spotLight = spotLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( spotShadowMap[ i ], spotLight.shadowMapSize, spotLight.shadowIntensity, spotLight.shadowBias, spotLight.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0 && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
	PointLightShadow pointLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
		pointLight = pointLightShadows[ i ];
		shadow *= receiveShadow ? getPointShadow( pointShadowMap[ i ], pointLight.shadowMapSize, pointLight.shadowIntensity, pointLight.shadowBias, pointLight.shadowRadius, vPointShadowCoord[ i ], pointLight.shadowCameraNear, pointLight.shadowCameraFar ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#endif
	return shadow;
}`,CR=`#ifdef USE_SKINNING
	mat4 boneMatX = getBoneMatrix( skinIndex.x );
	mat4 boneMatY = getBoneMatrix( skinIndex.y );
	mat4 boneMatZ = getBoneMatrix( skinIndex.z );
	mat4 boneMatW = getBoneMatrix( skinIndex.w );
#endif`,RR=`#ifdef USE_SKINNING
	uniform mat4 bindMatrix;
	uniform mat4 bindMatrixInverse;
	uniform highp sampler2D boneTexture;
	mat4 getBoneMatrix( const in float i ) {
		int size = textureSize( boneTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( boneTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( boneTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( boneTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( boneTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
#endif`,PR=`#ifdef USE_SKINNING
	vec4 skinVertex = bindMatrix * vec4( transformed, 1.0 );
	vec4 skinned = vec4( 0.0 );
	skinned += boneMatX * skinVertex * skinWeight.x;
	skinned += boneMatY * skinVertex * skinWeight.y;
	skinned += boneMatZ * skinVertex * skinWeight.z;
	skinned += boneMatW * skinVertex * skinWeight.w;
	transformed = ( bindMatrixInverse * skinned ).xyz;
#endif`,kR=`#ifdef USE_SKINNING
	mat4 skinMatrix = mat4( 0.0 );
	skinMatrix += skinWeight.x * boneMatX;
	skinMatrix += skinWeight.y * boneMatY;
	skinMatrix += skinWeight.z * boneMatZ;
	skinMatrix += skinWeight.w * boneMatW;
	skinMatrix = bindMatrixInverse * skinMatrix * bindMatrix;
	objectNormal = vec4( skinMatrix * vec4( objectNormal, 0.0 ) ).xyz;
	#ifdef USE_TANGENT
		objectTangent = vec4( skinMatrix * vec4( objectTangent, 0.0 ) ).xyz;
	#endif
#endif`,LR=`float specularStrength;
#ifdef USE_SPECULARMAP
	vec4 texelSpecular = texture2D( specularMap, vSpecularMapUv );
	specularStrength = texelSpecular.r;
#else
	specularStrength = 1.0;
#endif`,IR=`#ifdef USE_SPECULARMAP
	uniform sampler2D specularMap;
#endif`,DR=`#if defined( TONE_MAPPING )
	gl_FragColor.rgb = toneMapping( gl_FragColor.rgb );
#endif`,NR=`#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
uniform float toneMappingExposure;
vec3 LinearToneMapping( vec3 color ) {
	return saturate( toneMappingExposure * color );
}
vec3 ReinhardToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	return saturate( color / ( vec3( 1.0 ) + color ) );
}
vec3 CineonToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	color = max( vec3( 0.0 ), color - 0.004 );
	return pow( ( color * ( 6.2 * color + 0.5 ) ) / ( color * ( 6.2 * color + 1.7 ) + 0.06 ), vec3( 2.2 ) );
}
vec3 RRTAndODTFit( vec3 v ) {
	vec3 a = v * ( v + 0.0245786 ) - 0.000090537;
	vec3 b = v * ( 0.983729 * v + 0.4329510 ) + 0.238081;
	return a / b;
}
vec3 ACESFilmicToneMapping( vec3 color ) {
	const mat3 ACESInputMat = mat3(
		vec3( 0.59719, 0.07600, 0.02840 ),		vec3( 0.35458, 0.90834, 0.13383 ),
		vec3( 0.04823, 0.01566, 0.83777 )
	);
	const mat3 ACESOutputMat = mat3(
		vec3(  1.60475, -0.10208, -0.00327 ),		vec3( -0.53108,  1.10813, -0.07276 ),
		vec3( -0.07367, -0.00605,  1.07602 )
	);
	color *= toneMappingExposure / 0.6;
	color = ACESInputMat * color;
	color = RRTAndODTFit( color );
	color = ACESOutputMat * color;
	return saturate( color );
}
const mat3 LINEAR_REC2020_TO_LINEAR_SRGB = mat3(
	vec3( 1.6605, - 0.1246, - 0.0182 ),
	vec3( - 0.5876, 1.1329, - 0.1006 ),
	vec3( - 0.0728, - 0.0083, 1.1187 )
);
const mat3 LINEAR_SRGB_TO_LINEAR_REC2020 = mat3(
	vec3( 0.6274, 0.0691, 0.0164 ),
	vec3( 0.3293, 0.9195, 0.0880 ),
	vec3( 0.0433, 0.0113, 0.8956 )
);
vec3 agxDefaultContrastApprox( vec3 x ) {
	vec3 x2 = x * x;
	vec3 x4 = x2 * x2;
	return + 15.5 * x4 * x2
		- 40.14 * x4 * x
		+ 31.96 * x4
		- 6.868 * x2 * x
		+ 0.4298 * x2
		+ 0.1191 * x
		- 0.00232;
}
vec3 AgXToneMapping( vec3 color ) {
	const mat3 AgXInsetMatrix = mat3(
		vec3( 0.856627153315983, 0.137318972929847, 0.11189821299995 ),
		vec3( 0.0951212405381588, 0.761241990602591, 0.0767994186031903 ),
		vec3( 0.0482516061458583, 0.101439036467562, 0.811302368396859 )
	);
	const mat3 AgXOutsetMatrix = mat3(
		vec3( 1.1271005818144368, - 0.1413297634984383, - 0.14132976349843826 ),
		vec3( - 0.11060664309660323, 1.157823702216272, - 0.11060664309660294 ),
		vec3( - 0.016493938717834573, - 0.016493938717834257, 1.2519364065950405 )
	);
	const float AgxMinEv = - 12.47393;	const float AgxMaxEv = 4.026069;
	color *= toneMappingExposure;
	color = LINEAR_SRGB_TO_LINEAR_REC2020 * color;
	color = AgXInsetMatrix * color;
	color = max( color, 1e-10 );	color = log2( color );
	color = ( color - AgxMinEv ) / ( AgxMaxEv - AgxMinEv );
	color = clamp( color, 0.0, 1.0 );
	color = agxDefaultContrastApprox( color );
	color = AgXOutsetMatrix * color;
	color = pow( max( vec3( 0.0 ), color ), vec3( 2.2 ) );
	color = LINEAR_REC2020_TO_LINEAR_SRGB * color;
	color = clamp( color, 0.0, 1.0 );
	return color;
}
vec3 NeutralToneMapping( vec3 color ) {
	const float StartCompression = 0.8 - 0.04;
	const float Desaturation = 0.15;
	color *= toneMappingExposure;
	float x = min( color.r, min( color.g, color.b ) );
	float offset = x < 0.08 ? x - 6.25 * x * x : 0.04;
	color -= offset;
	float peak = max( color.r, max( color.g, color.b ) );
	if ( peak < StartCompression ) return color;
	float d = 1. - StartCompression;
	float newPeak = 1. - d * d / ( peak + d - StartCompression );
	color *= newPeak / peak;
	float g = 1. - 1. / ( Desaturation * ( peak - newPeak ) + 1. );
	return mix( color, vec3( newPeak ), g );
}
vec3 CustomToneMapping( vec3 color ) { return color; }`,OR=`#ifdef USE_TRANSMISSION
	material.transmission = transmission;
	material.transmissionAlpha = 1.0;
	material.thickness = thickness;
	material.attenuationDistance = attenuationDistance;
	material.attenuationColor = attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		material.transmission *= texture2D( transmissionMap, vTransmissionMapUv ).r;
	#endif
	#ifdef USE_THICKNESSMAP
		material.thickness *= texture2D( thicknessMap, vThicknessMapUv ).g;
	#endif
	vec3 pos = vWorldPosition;
	vec3 v = normalize( cameraPosition - pos );
	vec3 n = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec4 transmitted = getIBLVolumeRefraction(
		n, v, material.roughness, material.diffuseContribution, material.specularColorBlended, material.specularF90,
		pos, modelMatrix, viewMatrix, projectionMatrix, material.dispersion, material.ior, material.thickness,
		material.attenuationColor, material.attenuationDistance );
	material.transmissionAlpha = mix( material.transmissionAlpha, transmitted.a, material.transmission );
	totalDiffuse = mix( totalDiffuse, transmitted.rgb, material.transmission );
#endif`,FR=`#ifdef USE_TRANSMISSION
	uniform float transmission;
	uniform float thickness;
	uniform float attenuationDistance;
	uniform vec3 attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		uniform sampler2D transmissionMap;
	#endif
	#ifdef USE_THICKNESSMAP
		uniform sampler2D thicknessMap;
	#endif
	uniform vec2 transmissionSamplerSize;
	uniform sampler2D transmissionSamplerMap;
	uniform mat4 modelMatrix;
	uniform mat4 projectionMatrix;
	varying vec3 vWorldPosition;
	float w0( float a ) {
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - a + 3.0 ) - 3.0 ) + 1.0 );
	}
	float w1( float a ) {
		return ( 1.0 / 6.0 ) * ( a *  a * ( 3.0 * a - 6.0 ) + 4.0 );
	}
	float w2( float a ){
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - 3.0 * a + 3.0 ) + 3.0 ) + 1.0 );
	}
	float w3( float a ) {
		return ( 1.0 / 6.0 ) * ( a * a * a );
	}
	float g0( float a ) {
		return w0( a ) + w1( a );
	}
	float g1( float a ) {
		return w2( a ) + w3( a );
	}
	float h0( float a ) {
		return - 1.0 + w1( a ) / ( w0( a ) + w1( a ) );
	}
	float h1( float a ) {
		return 1.0 + w3( a ) / ( w2( a ) + w3( a ) );
	}
	vec4 bicubic( sampler2D tex, vec2 uv, vec4 texelSize, float lod ) {
		uv = uv * texelSize.zw + 0.5;
		vec2 iuv = floor( uv );
		vec2 fuv = fract( uv );
		float g0x = g0( fuv.x );
		float g1x = g1( fuv.x );
		float h0x = h0( fuv.x );
		float h1x = h1( fuv.x );
		float h0y = h0( fuv.y );
		float h1y = h1( fuv.y );
		vec2 p0 = ( vec2( iuv.x + h0x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p1 = ( vec2( iuv.x + h1x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p2 = ( vec2( iuv.x + h0x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		vec2 p3 = ( vec2( iuv.x + h1x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		return g0( fuv.y ) * ( g0x * textureLod( tex, p0, lod ) + g1x * textureLod( tex, p1, lod ) ) +
			g1( fuv.y ) * ( g0x * textureLod( tex, p2, lod ) + g1x * textureLod( tex, p3, lod ) );
	}
	vec4 textureBicubic( sampler2D sampler, vec2 uv, float lod ) {
		vec2 fLodSize = vec2( textureSize( sampler, int( lod ) ) );
		vec2 cLodSize = vec2( textureSize( sampler, int( lod + 1.0 ) ) );
		vec2 fLodSizeInv = 1.0 / fLodSize;
		vec2 cLodSizeInv = 1.0 / cLodSize;
		vec4 fSample = bicubic( sampler, uv, vec4( fLodSizeInv, fLodSize ), floor( lod ) );
		vec4 cSample = bicubic( sampler, uv, vec4( cLodSizeInv, cLodSize ), ceil( lod ) );
		return mix( fSample, cSample, fract( lod ) );
	}
	vec3 getVolumeTransmissionRay( const in vec3 n, const in vec3 v, const in float thickness, const in float ior, const in mat4 modelMatrix ) {
		vec3 refractionVector = refract( - v, normalize( n ), 1.0 / ior );
		vec3 modelScale;
		modelScale.x = length( vec3( modelMatrix[ 0 ].xyz ) );
		modelScale.y = length( vec3( modelMatrix[ 1 ].xyz ) );
		modelScale.z = length( vec3( modelMatrix[ 2 ].xyz ) );
		return normalize( refractionVector ) * thickness * modelScale;
	}
	float applyIorToRoughness( const in float roughness, const in float ior ) {
		return roughness * clamp( ior * 2.0 - 2.0, 0.0, 1.0 );
	}
	vec4 getTransmissionSample( const in vec2 fragCoord, const in float roughness, const in float ior ) {
		float lod = log2( transmissionSamplerSize.x ) * applyIorToRoughness( roughness, ior );
		return textureBicubic( transmissionSamplerMap, fragCoord.xy, lod );
	}
	vec3 volumeAttenuation( const in float transmissionDistance, const in vec3 attenuationColor, const in float attenuationDistance ) {
		if ( isinf( attenuationDistance ) ) {
			return vec3( 1.0 );
		} else {
			vec3 attenuationCoefficient = -log( attenuationColor ) / attenuationDistance;
			vec3 transmittance = exp( - attenuationCoefficient * transmissionDistance );			return transmittance;
		}
	}
	vec4 getIBLVolumeRefraction( const in vec3 n, const in vec3 v, const in float roughness, const in vec3 diffuseColor,
		const in vec3 specularColor, const in float specularF90, const in vec3 position, const in mat4 modelMatrix,
		const in mat4 viewMatrix, const in mat4 projMatrix, const in float dispersion, const in float ior, const in float thickness,
		const in vec3 attenuationColor, const in float attenuationDistance ) {
		vec4 transmittedLight;
		vec3 transmittance;
		#ifdef USE_DISPERSION
			float halfSpread = ( ior - 1.0 ) * 0.025 * dispersion;
			vec3 iors = vec3( ior - halfSpread, ior, ior + halfSpread );
			for ( int i = 0; i < 3; i ++ ) {
				vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, iors[ i ], modelMatrix );
				vec3 refractedRayExit = position + transmissionRay;
				vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
				vec2 refractionCoords = ndcPos.xy / ndcPos.w;
				refractionCoords += 1.0;
				refractionCoords /= 2.0;
				vec4 transmissionSample = getTransmissionSample( refractionCoords, roughness, iors[ i ] );
				transmittedLight[ i ] = transmissionSample[ i ];
				transmittedLight.a += transmissionSample.a;
				transmittance[ i ] = diffuseColor[ i ] * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance )[ i ];
			}
			transmittedLight.a /= 3.0;
		#else
			vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, ior, modelMatrix );
			vec3 refractedRayExit = position + transmissionRay;
			vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
			vec2 refractionCoords = ndcPos.xy / ndcPos.w;
			refractionCoords += 1.0;
			refractionCoords /= 2.0;
			transmittedLight = getTransmissionSample( refractionCoords, roughness, ior );
			transmittance = diffuseColor * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance );
		#endif
		vec3 attenuatedColor = transmittance * transmittedLight.rgb;
		vec3 F = EnvironmentBRDF( n, v, specularColor, specularF90, roughness );
		float transmittanceFactor = ( transmittance.r + transmittance.g + transmittance.b ) / 3.0;
		return vec4( ( 1.0 - F ) * attenuatedColor, 1.0 - ( 1.0 - transmittedLight.a ) * transmittanceFactor );
	}
#endif`,BR=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_SPECULARMAP
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,UR=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	uniform mat3 mapTransform;
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	uniform mat3 alphaMapTransform;
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	uniform mat3 lightMapTransform;
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	uniform mat3 aoMapTransform;
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	uniform mat3 bumpMapTransform;
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	uniform mat3 normalMapTransform;
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_DISPLACEMENTMAP
	uniform mat3 displacementMapTransform;
	varying vec2 vDisplacementMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	uniform mat3 emissiveMapTransform;
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	uniform mat3 metalnessMapTransform;
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	uniform mat3 roughnessMapTransform;
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	uniform mat3 diffuseRoughnessMapTransform;
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	uniform mat3 anisotropyMapTransform;
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	uniform mat3 clearcoatMapTransform;
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform mat3 clearcoatNormalMapTransform;
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform mat3 clearcoatRoughnessMapTransform;
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	uniform mat3 sheenColorMapTransform;
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	uniform mat3 sheenRoughnessMapTransform;
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	uniform mat3 iridescenceMapTransform;
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform mat3 iridescenceThicknessMapTransform;
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SPECULARMAP
	uniform mat3 specularMapTransform;
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	uniform mat3 specularColorMapTransform;
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	uniform mat3 specularIntensityMapTransform;
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,zR=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	vUv = vec3( uv, 1 ).xy;
#endif
#ifdef USE_MAP
	vMapUv = ( mapTransform * vec3( MAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ALPHAMAP
	vAlphaMapUv = ( alphaMapTransform * vec3( ALPHAMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_LIGHTMAP
	vLightMapUv = ( lightMapTransform * vec3( LIGHTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_AOMAP
	vAoMapUv = ( aoMapTransform * vec3( AOMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_BUMPMAP
	vBumpMapUv = ( bumpMapTransform * vec3( BUMPMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_NORMALMAP
	vNormalMapUv = ( normalMapTransform * vec3( NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DISPLACEMENTMAP
	vDisplacementMapUv = ( displacementMapTransform * vec3( DISPLACEMENTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_EMISSIVEMAP
	vEmissiveMapUv = ( emissiveMapTransform * vec3( EMISSIVEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_METALNESSMAP
	vMetalnessMapUv = ( metalnessMapTransform * vec3( METALNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ROUGHNESSMAP
	vRoughnessMapUv = ( roughnessMapTransform * vec3( ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	vDiffuseRoughnessMapUv = ( diffuseRoughnessMapTransform * vec3( DIFFUSE_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ANISOTROPYMAP
	vAnisotropyMapUv = ( anisotropyMapTransform * vec3( ANISOTROPYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOATMAP
	vClearcoatMapUv = ( clearcoatMapTransform * vec3( CLEARCOATMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	vClearcoatNormalMapUv = ( clearcoatNormalMapTransform * vec3( CLEARCOAT_NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	vClearcoatRoughnessMapUv = ( clearcoatRoughnessMapTransform * vec3( CLEARCOAT_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCEMAP
	vIridescenceMapUv = ( iridescenceMapTransform * vec3( IRIDESCENCEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	vIridescenceThicknessMapUv = ( iridescenceThicknessMapTransform * vec3( IRIDESCENCE_THICKNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_COLORMAP
	vSheenColorMapUv = ( sheenColorMapTransform * vec3( SHEEN_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	vSheenRoughnessMapUv = ( sheenRoughnessMapTransform * vec3( SHEEN_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULARMAP
	vSpecularMapUv = ( specularMapTransform * vec3( SPECULARMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_COLORMAP
	vSpecularColorMapUv = ( specularColorMapTransform * vec3( SPECULAR_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	vSpecularIntensityMapUv = ( specularIntensityMapTransform * vec3( SPECULAR_INTENSITYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_TRANSMISSIONMAP
	vTransmissionMapUv = ( transmissionMapTransform * vec3( TRANSMISSIONMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_THICKNESSMAP
	vThicknessMapUv = ( thicknessMapTransform * vec3( THICKNESSMAP_UV, 1 ) ).xy;
#endif`,VR=`#if defined( USE_ENVMAP ) || defined( DISTANCE ) || defined ( USE_SHADOWMAP ) || defined ( USE_TRANSMISSION ) || NUM_SPOT_LIGHT_COORDS > 0
	vec4 worldPosition = vec4( transformed, 1.0 );
	#ifdef USE_BATCHING
		worldPosition = batchingMatrix * worldPosition;
	#endif
	#ifdef USE_INSTANCING
		worldPosition = instanceMatrix * worldPosition;
	#endif
	worldPosition = modelMatrix * worldPosition;
#endif`,HR=`varying vec2 vUv;
uniform mat3 uvTransform;
void main() {
	vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	gl_Position = vec4( position.xy, 1.0, 1.0 );
}`,GR=`uniform sampler2D t2D;
uniform float backgroundIntensity;
varying vec2 vUv;
void main() {
	vec4 texColor = texture2D( t2D, vUv );
	#ifdef DECODE_VIDEO_TEXTURE
		texColor = vec4( mix( pow( texColor.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), texColor.rgb * 0.0773993808, vec3( lessThanEqual( texColor.rgb, vec3( 0.04045 ) ) ) ), texColor.w );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,WR=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,qR=`uniform float backgroundBlurriness;
uniform float backgroundIntensity;
uniform mat3 backgroundRotation;
varying vec3 vWorldDirection;
#include <envmap_common_pars_fragment>
void main() {
	#ifdef ENVMAP_TYPE_PMREM
		vec4 texColor = textureLod( envMap, backgroundRotation * vWorldDirection, roughnessToMip( backgroundBlurriness ) );
	#else
		vec4 texColor = textureCube( envMap, backgroundRotation * vWorldDirection );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,XR=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,$R=`uniform samplerCube tCube;
uniform float tFlip;
uniform float opacity;
varying vec3 vWorldDirection;
void main() {
	vec4 texColor = textureCube( tCube, vec3( tFlip * vWorldDirection.x, vWorldDirection.yz ) );
	gl_FragColor = texColor;
	gl_FragColor.a *= opacity;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,YR=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
varying vec2 vHighPrecisionZW;
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vHighPrecisionZW = gl_Position.zw;
}`,KR=`#if DEPTH_PACKING == 3200
	uniform float opacity;
#endif
#include <common>
#include <packing>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
varying vec2 vHighPrecisionZW;
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#if DEPTH_PACKING == 3200
		diffuseColor.a = opacity;
	#endif
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <logdepthbuf_fragment>
	#ifdef USE_REVERSED_DEPTH_BUFFER
		float fragCoordZ = vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ];
	#else
		float fragCoordZ = 0.5 * vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ] + 0.5;
	#endif
	#if DEPTH_PACKING == 3200
		gl_FragColor = vec4( vec3( 1.0 - fragCoordZ ), opacity );
	#elif DEPTH_PACKING == 3201
		gl_FragColor = packDepthToRGBA( fragCoordZ );
	#elif DEPTH_PACKING == 3202
		gl_FragColor = vec4( packDepthToRGB( fragCoordZ ), 1.0 );
	#elif DEPTH_PACKING == 3203
		gl_FragColor = vec4( packDepthToRG( fragCoordZ ), 0.0, 1.0 );
	#endif
}`,JR=`#define DISTANCE
varying vec3 vWorldPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <worldpos_vertex>
	#include <clipping_planes_vertex>
	vWorldPosition = worldPosition.xyz;
}`,ZR=`#define DISTANCE
uniform vec3 referencePosition;
uniform float nearDistance;
uniform float farDistance;
varying vec3 vWorldPosition;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	float dist = length( vWorldPosition - referencePosition );
	dist = ( dist - nearDistance ) / ( farDistance - nearDistance );
	dist = saturate( dist );
	gl_FragColor = vec4( dist, 0.0, 0.0, 1.0 );
}`,jR=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
}`,QR=`uniform sampler2D tEquirect;
varying vec3 vWorldDirection;
#include <common>
void main() {
	vec3 direction = normalize( vWorldDirection );
	vec2 sampleUV = equirectUv( direction );
	gl_FragColor = texture2D( tEquirect, sampleUV );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,eP=`uniform float scale;
attribute float lineDistance;
varying float vLineDistance;
#include <common>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	vLineDistance = scale * lineDistance;
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,tP=`uniform vec3 diffuse;
uniform float opacity;
uniform float dashSize;
uniform float totalSize;
varying float vLineDistance;
#include <common>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	if ( mod( vLineDistance, totalSize ) > dashSize ) {
		discard;
	}
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,iP=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#if defined ( USE_ENVMAP ) || defined ( USE_SKINNING )
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinbase_vertex>
		#include <skinnormal_vertex>
		#include <defaultnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <fog_vertex>
}`,nP=`uniform vec3 diffuse;
uniform float opacity;
#ifndef FLAT_SHADED
	varying vec3 vNormal;
#endif
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <fog_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		reflectedLight.indirectDiffuse += lightMapTexel.rgb * lightMapIntensity * RECIPROCAL_PI;
	#else
		reflectedLight.indirectDiffuse += vec3( 1.0 );
	#endif
	#include <aomap_fragment>
	reflectedLight.indirectDiffuse *= diffuseColor.rgb;
	vec3 outgoingLight = reflectedLight.indirectDiffuse;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,sP=`#define LAMBERT
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,rP=`#define LAMBERT
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_lambert_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_lambert_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,oP=`#define MATCAP
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <displacementmap_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
	vViewPosition = - mvPosition.xyz;
}`,aP=`#define MATCAP
uniform vec3 diffuse;
uniform float opacity;
uniform sampler2D matcap;
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	vec3 viewDir = normalize( vViewPosition );
	vec3 x = normalize( vec3( viewDir.z, 0.0, - viewDir.x ) );
	vec3 y = cross( viewDir, x );
	vec2 uv = vec2( dot( x, normal ), dot( y, normal ) ) * 0.495 + 0.5;
	#ifdef USE_MATCAP
		vec4 matcapColor = texture2D( matcap, uv );
	#else
		vec4 matcapColor = vec4( vec3( mix( 0.2, 0.8, uv.y ) ), 1.0 );
	#endif
	vec3 outgoingLight = diffuseColor.rgb * matcapColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,lP=`#define NORMAL
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	vViewPosition = - mvPosition.xyz;
#endif
}`,cP=`#define NORMAL
uniform float opacity;
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <uv_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 0.0, 0.0, 0.0, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	gl_FragColor = vec4( normalize( normal ) * 0.5 + 0.5, diffuseColor.a );
	#ifdef OPAQUE
		gl_FragColor.a = 1.0;
	#endif
}`,hP=`#define PHONG
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,uP=`#define PHONG
uniform vec3 diffuse;
uniform vec3 emissive;
uniform vec3 specular;
uniform float shininess;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_phong_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_phong_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + reflectedLight.directSpecular + reflectedLight.indirectSpecular + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,fP=`#define STANDARD
varying vec3 vViewPosition;
#ifdef USE_TRANSMISSION
	varying vec3 vWorldPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
#ifdef USE_TRANSMISSION
	vWorldPosition = worldPosition.xyz;
#endif
}`,dP=`#define STANDARD
#ifdef PHYSICAL
	#define IOR
	#define USE_SPECULAR
#endif
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float roughness;
uniform float metalness;
uniform float opacity;
#ifdef IOR
	uniform float ior;
#endif
#ifdef USE_SPECULAR
	uniform float specularIntensity;
	uniform vec3 specularColor;
	#ifdef USE_SPECULAR_COLORMAP
		uniform sampler2D specularColorMap;
	#endif
	#ifdef USE_SPECULAR_INTENSITYMAP
		uniform sampler2D specularIntensityMap;
	#endif
#endif
#ifdef USE_CLEARCOAT
	uniform float clearcoat;
	uniform float clearcoatRoughness;
#endif
#ifdef USE_DIFFUSE_ROUGHNESS
	uniform float diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		uniform sampler2D diffuseRoughnessMap;
	#endif
#endif
#ifdef USE_DISPERSION
	uniform float dispersion;
#endif
#ifdef USE_RETROREFLECTION
	uniform float retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	uniform float iridescence;
	uniform float iridescenceIOR;
	uniform float iridescenceThicknessMinimum;
	uniform float iridescenceThicknessMaximum;
#endif
#ifdef USE_SHEEN
	uniform vec3 sheenColor;
	uniform float sheenRoughness;
	#ifdef USE_SHEEN_COLORMAP
		uniform sampler2D sheenColorMap;
	#endif
	#ifdef USE_SHEEN_ROUGHNESSMAP
		uniform sampler2D sheenRoughnessMap;
	#endif
#endif
#ifdef USE_ANISOTROPY
	uniform vec2 anisotropyVector;
	#ifdef USE_ANISOTROPYMAP
		uniform sampler2D anisotropyMap;
	#endif
#endif
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <iridescence_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_physical_pars_fragment>
#include <transmission_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <clearcoat_pars_fragment>
#include <iridescence_pars_fragment>
#include <roughnessmap_pars_fragment>
#include <metalnessmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <roughnessmap_fragment>
	#include <metalnessmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <clearcoat_normal_fragment_begin>
	#include <clearcoat_normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_physical_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 totalDiffuse = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse;
	vec3 totalSpecular = reflectedLight.directSpecular + reflectedLight.indirectSpecular;
	#include <transmission_fragment>
	vec3 outgoingLight = totalDiffuse + totalSpecular + totalEmissiveRadiance;
	#ifdef USE_SHEEN
 
		outgoingLight = outgoingLight + sheenSpecularDirect + sheenSpecularIndirect;
 
 	#endif
	#ifdef USE_CLEARCOAT
		float dotNVcc = saturate( dot( geometryClearcoatNormal, geometryViewDir ) );
		vec3 Fcc = F_Schlick( material.clearcoatF0, material.clearcoatF90, dotNVcc );
		outgoingLight = outgoingLight * ( 1.0 - material.clearcoat * Fcc ) + ( clearcoatSpecularDirect + clearcoatSpecularIndirect ) * material.clearcoat;
	#endif
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,pP=`#define TOON
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,mP=`#define TOON
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <gradientmap_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_toon_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_toon_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,gP=`uniform float size;
uniform float scale;
#include <common>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
#ifdef USE_POINTS_UV
	varying vec2 vUv;
	uniform mat3 uvTransform;
#endif
void main() {
	#ifdef USE_POINTS_UV
		vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	#endif
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	gl_PointSize = size;
	#ifdef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) gl_PointSize *= ( scale / - mvPosition.z );
	#endif
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <fog_vertex>
}`,xP=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <color_pars_fragment>
#include <map_particle_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_particle_fragment>
	#include <color_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,vP=`#include <common>
#include <batching_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <shadowmap_pars_vertex>
void main() {
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,yP=`uniform vec3 color;
uniform float opacity;
#include <common>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <logdepthbuf_pars_fragment>
#include <shadowmap_pars_fragment>
#include <shadowmask_pars_fragment>
void main() {
	#include <logdepthbuf_fragment>
	gl_FragColor = vec4( color, opacity * ( 1.0 - getShadowMask() ) );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,bP=`uniform float rotation;
uniform vec2 center;
#include <common>
#include <uv_pars_vertex>
#include <fog_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	vec4 mvPosition = modelViewMatrix[ 3 ];
	vec2 scale = vec2( length( modelMatrix[ 0 ].xyz ), length( modelMatrix[ 1 ].xyz ) );
	#ifndef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) scale *= - mvPosition.z;
	#endif
	vec2 alignedPosition = ( position.xy - ( center - vec2( 0.5 ) ) ) * scale;
	vec2 rotatedPosition;
	rotatedPosition.x = cos( rotation ) * alignedPosition.x - sin( rotation ) * alignedPosition.y;
	rotatedPosition.y = sin( rotation ) * alignedPosition.x + cos( rotation ) * alignedPosition.y;
	mvPosition.xy += rotatedPosition;
	gl_Position = projectionMatrix * mvPosition;
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,_P=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
}`,ye={alphahash_fragment:GE,alphahash_pars_fragment:WE,alphamap_fragment:qE,alphamap_pars_fragment:XE,alphatest_fragment:$E,alphatest_pars_fragment:YE,aomap_fragment:KE,aomap_pars_fragment:JE,batching_pars_vertex:ZE,batching_vertex:jE,begin_vertex:QE,beginnormal_vertex:eC,bsdfs:tC,iridescence_fragment:iC,bumpmap_pars_fragment:nC,clipping_planes_fragment:sC,clipping_planes_pars_fragment:rC,clipping_planes_pars_vertex:oC,clipping_planes_vertex:aC,color_fragment:lC,color_pars_fragment:cC,color_pars_vertex:hC,color_vertex:uC,common:fC,defaultnormal_vertex:dC,displacementmap_pars_vertex:pC,displacementmap_vertex:mC,emissivemap_fragment:gC,emissivemap_pars_fragment:xC,colorspace_fragment:vC,colorspace_pars_fragment:yC,envmap_fragment:bC,envmap_common_pars_fragment:_C,envmap_pars_fragment:SC,envmap_pars_vertex:wC,envmap_physical_pars_fragment:DC,envmap_vertex:MC,fog_vertex:AC,fog_pars_vertex:TC,fog_fragment:EC,fog_pars_fragment:CC,gradientmap_pars_fragment:RC,lightmap_pars_fragment:PC,lights_lambert_fragment:kC,lights_lambert_pars_fragment:LC,lights_pars_begin:IC,lights_toon_fragment:NC,lights_toon_pars_fragment:OC,lights_phong_fragment:FC,lights_phong_pars_fragment:BC,lights_physical_fragment:UC,lights_physical_pars_fragment:zC,lights_fragment_begin:VC,lights_fragment_maps:HC,lights_fragment_end:GC,lightprobes_pars_fragment:WC,logdepthbuf_fragment:qC,logdepthbuf_pars_fragment:XC,logdepthbuf_pars_vertex:$C,logdepthbuf_vertex:YC,map_fragment:KC,map_pars_fragment:JC,map_particle_fragment:ZC,map_particle_pars_fragment:jC,metalnessmap_fragment:QC,metalnessmap_pars_fragment:eR,morphinstance_vertex:tR,morphcolor_vertex:iR,morphnormal_vertex:nR,morphtarget_pars_vertex:sR,morphtarget_vertex:rR,normal_fragment_begin:oR,normal_fragment_maps:aR,normal_pars_fragment:lR,normal_pars_vertex:cR,normal_vertex:hR,normalmap_pars_fragment:uR,clearcoat_normal_fragment_begin:fR,clearcoat_normal_fragment_maps:dR,clearcoat_pars_fragment:pR,iridescence_pars_fragment:mR,opaque_fragment:gR,packing:xR,premultiplied_alpha_fragment:vR,project_vertex:yR,dithering_fragment:bR,dithering_pars_fragment:_R,roughnessmap_fragment:SR,roughnessmap_pars_fragment:wR,shadowmap_pars_fragment:MR,shadowmap_pars_vertex:AR,shadowmap_vertex:TR,shadowmask_pars_fragment:ER,skinbase_vertex:CR,skinning_pars_vertex:RR,skinning_vertex:PR,skinnormal_vertex:kR,specularmap_fragment:LR,specularmap_pars_fragment:IR,tonemapping_fragment:DR,tonemapping_pars_fragment:NR,transmission_fragment:OR,transmission_pars_fragment:FR,uv_pars_fragment:BR,uv_pars_vertex:UR,uv_vertex:zR,worldpos_vertex:VR,background_vert:HR,background_frag:GR,backgroundCube_vert:WR,backgroundCube_frag:qR,cube_vert:XR,cube_frag:$R,depth_vert:YR,depth_frag:KR,distance_vert:JR,distance_frag:ZR,equirect_vert:jR,equirect_frag:QR,linedashed_vert:eP,linedashed_frag:tP,meshbasic_vert:iP,meshbasic_frag:nP,meshlambert_vert:sP,meshlambert_frag:rP,meshmatcap_vert:oP,meshmatcap_frag:aP,meshnormal_vert:lP,meshnormal_frag:cP,meshphong_vert:hP,meshphong_frag:uP,meshphysical_vert:fP,meshphysical_frag:dP,meshtoon_vert:pP,meshtoon_frag:mP,points_vert:gP,points_frag:xP,shadow_vert:vP,shadow_frag:yP,sprite_vert:bP,sprite_frag:_P},J={common:{diffuse:{value:new wt(16777215)},opacity:{value:1},map:{value:null},mapTransform:{value:new pe},alphaMap:{value:null},alphaMapTransform:{value:new pe},alphaTest:{value:0}},specularmap:{specularMap:{value:null},specularMapTransform:{value:new pe}},envmap:{envMap:{value:null},envMapRotation:{value:new pe},reflectivity:{value:1},ior:{value:1.5},refractionRatio:{value:.98},dfgLUT:{value:null}},aomap:{aoMap:{value:null},aoMapIntensity:{value:1},aoMapTransform:{value:new pe}},lightmap:{lightMap:{value:null},lightMapIntensity:{value:1},lightMapTransform:{value:new pe}},bumpmap:{bumpMap:{value:null},bumpMapTransform:{value:new pe},bumpScale:{value:1}},normalmap:{normalMap:{value:null},normalMapTransform:{value:new pe},normalScale:{value:new Yi(1,1)}},displacementmap:{displacementMap:{value:null},displacementMapTransform:{value:new pe},displacementScale:{value:1},displacementBias:{value:0}},emissivemap:{emissiveMap:{value:null},emissiveMapTransform:{value:new pe}},metalnessmap:{metalnessMap:{value:null},metalnessMapTransform:{value:new pe}},roughnessmap:{roughnessMap:{value:null},roughnessMapTransform:{value:new pe}},gradientmap:{gradientMap:{value:null}},fog:{fogDensity:{value:25e-5},fogNear:{value:1},fogFar:{value:2e3},fogColor:{value:new wt(16777215)}},lights:{ambientLightColor:{value:[]},lightProbe:{value:[]},sunLights:{value:[],properties:{direction:{},color:{}}},sunLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},sunShadowMatrix:{value:[]},sunShadowCascade:{value:[]},directionalLights:{value:[],properties:{direction:{},color:{}}},directionalLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},directionalShadowMatrix:{value:[]},spotLights:{value:[],properties:{color:{},position:{},direction:{},distance:{},coneCos:{},penumbraCos:{},decay:{}}},spotLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},spotLightMap:{value:[]},spotLightMatrix:{value:[]},pointLights:{value:[],properties:{color:{},position:{},decay:{},distance:{}}},pointLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{},shadowCameraNear:{},shadowCameraFar:{}}},pointShadowMatrix:{value:[]},hemisphereLights:{value:[],properties:{direction:{},skyColor:{},groundColor:{}}},rectAreaLights:{value:[],properties:{color:{},position:{},width:{},height:{}}},ltc_1:{value:null},ltc_2:{value:null},probesSH:{value:[]},probesMin:{value:[]},probesMax:{value:[]},probesResolution:{value:[]}},points:{diffuse:{value:new wt(16777215)},opacity:{value:1},size:{value:1},scale:{value:1},map:{value:null},alphaMap:{value:null},alphaMapTransform:{value:new pe},alphaTest:{value:0},uvTransform:{value:new pe}},sprite:{diffuse:{value:new wt(16777215)},opacity:{value:1},center:{value:new Yi(.5,.5)},rotation:{value:0},map:{value:null},mapTransform:{value:new pe},alphaMap:{value:null},alphaMapTransform:{value:new pe},alphaTest:{value:0}}},Eb={basic:{uniforms:Wt([J.common,J.specularmap,J.envmap,J.aomap,J.lightmap,J.fog]),vertexShader:ye.meshbasic_vert,fragmentShader:ye.meshbasic_frag},lambert:{uniforms:Wt([J.common,J.specularmap,J.envmap,J.aomap,J.lightmap,J.emissivemap,J.bumpmap,J.normalmap,J.displacementmap,J.fog,J.lights,{emissive:{value:new wt(0)},envMapIntensity:{value:1}}]),vertexShader:ye.meshlambert_vert,fragmentShader:ye.meshlambert_frag},phong:{uniforms:Wt([J.common,J.specularmap,J.envmap,J.aomap,J.lightmap,J.emissivemap,J.bumpmap,J.normalmap,J.displacementmap,J.fog,J.lights,{emissive:{value:new wt(0)},specular:{value:new wt(1118481)},shininess:{value:30},envMapIntensity:{value:1}}]),vertexShader:ye.meshphong_vert,fragmentShader:ye.meshphong_frag},standard:{uniforms:Wt([J.common,J.envmap,J.aomap,J.lightmap,J.emissivemap,J.bumpmap,J.normalmap,J.displacementmap,J.roughnessmap,J.metalnessmap,J.fog,J.lights,{emissive:{value:new wt(0)},roughness:{value:1},metalness:{value:0},envMapIntensity:{value:1}}]),vertexShader:ye.meshphysical_vert,fragmentShader:ye.meshphysical_frag},toon:{uniforms:Wt([J.common,J.aomap,J.lightmap,J.emissivemap,J.bumpmap,J.normalmap,J.displacementmap,J.gradientmap,J.fog,J.lights,{emissive:{value:new wt(0)}}]),vertexShader:ye.meshtoon_vert,fragmentShader:ye.meshtoon_frag},matcap:{uniforms:Wt([J.common,J.bumpmap,J.normalmap,J.displacementmap,J.fog,{matcap:{value:null}}]),vertexShader:ye.meshmatcap_vert,fragmentShader:ye.meshmatcap_frag},points:{uniforms:Wt([J.points,J.fog]),vertexShader:ye.points_vert,fragmentShader:ye.points_frag},dashed:{uniforms:Wt([J.common,J.fog,{scale:{value:1},dashSize:{value:1},totalSize:{value:2}}]),vertexShader:ye.linedashed_vert,fragmentShader:ye.linedashed_frag},depth:{uniforms:Wt([J.common,J.displacementmap]),vertexShader:ye.depth_vert,fragmentShader:ye.depth_frag},normal:{uniforms:Wt([J.common,J.bumpmap,J.normalmap,J.displacementmap,{opacity:{value:1}}]),vertexShader:ye.meshnormal_vert,fragmentShader:ye.meshnormal_frag},sprite:{uniforms:Wt([J.sprite,J.fog]),vertexShader:ye.sprite_vert,fragmentShader:ye.sprite_frag},background:{uniforms:{uvTransform:{value:new pe},t2D:{value:null},backgroundIntensity:{value:1}},vertexShader:ye.background_vert,fragmentShader:ye.background_frag},backgroundCube:{uniforms:{envMap:{value:null},backgroundBlurriness:{value:0},backgroundIntensity:{value:1},backgroundRotation:{value:new pe}},vertexShader:ye.backgroundCube_vert,fragmentShader:ye.backgroundCube_frag},cube:{uniforms:{tCube:{value:null},tFlip:{value:-1},opacity:{value:1}},vertexShader:ye.cube_vert,fragmentShader:ye.cube_frag},equirect:{uniforms:{tEquirect:{value:null}},vertexShader:ye.equirect_vert,fragmentShader:ye.equirect_frag},distance:{uniforms:Wt([J.common,J.displacementmap,{referencePosition:{value:new it},nearDistance:{value:1},farDistance:{value:1e3}}]),vertexShader:ye.distance_vert,fragmentShader:ye.distance_frag},shadow:{uniforms:Wt([J.lights,J.fog,{color:{value:new wt(0)},opacity:{value:1}}]),vertexShader:ye.shadow_vert,fragmentShader:ye.shadow_frag}};Eb.physical={uniforms:Wt([Eb.standard.uniforms,{clearcoat:{value:0},clearcoatMap:{value:null},clearcoatMapTransform:{value:new pe},clearcoatNormalMap:{value:null},clearcoatNormalMapTransform:{value:new pe},clearcoatNormalScale:{value:new Yi(1,1)},clearcoatRoughness:{value:0},clearcoatRoughnessMap:{value:null},clearcoatRoughnessMapTransform:{value:new pe},diffuseRoughness:{value:0},diffuseRoughnessMap:{value:null},diffuseRoughnessMapTransform:{value:new pe},dispersion:{value:0},retroreflectivity:{value:0},iridescence:{value:0},iridescenceMap:{value:null},iridescenceMapTransform:{value:new pe},iridescenceIOR:{value:1.3},iridescenceThicknessMinimum:{value:100},iridescenceThicknessMaximum:{value:400},iridescenceThicknessMap:{value:null},iridescenceThicknessMapTransform:{value:new pe},sheen:{value:0},sheenColor:{value:new wt(0)},sheenColorMap:{value:null},sheenColorMapTransform:{value:new pe},sheenRoughness:{value:1},sheenRoughnessMap:{value:null},sheenRoughnessMapTransform:{value:new pe},transmission:{value:0},transmissionMap:{value:null},transmissionMapTransform:{value:new pe},transmissionSamplerSize:{value:new Yi},transmissionSamplerMap:{value:null},thickness:{value:0},thicknessMap:{value:null},thicknessMapTransform:{value:new pe},attenuationDistance:{value:0},attenuationColor:{value:new wt(0)},specularColor:{value:new wt(1,1,1)},specularColorMap:{value:null},specularColorMapTransform:{value:new pe},specularIntensity:{value:1},specularIntensityMap:{value:null},specularIntensityMapTransform:{value:new pe},anisotropyVector:{value:new Yi},anisotropyMap:{value:null},anisotropyMapTransform:{value:new pe}}]),vertexShader:ye.meshphysical_vert,fragmentShader:ye.meshphysical_frag};var SP=new pe;SP.set(-1,0,0,0,1,0,0,0,1);var SF={[cp]:"LINEAR_TONE_MAPPING",[hp]:"REINHARD_TONE_MAPPING",[up]:"CINEON_TONE_MAPPING",[fp]:"ACES_FILMIC_TONE_MAPPING",[pp]:"AGX_TONE_MAPPING",[mp]:"NEUTRAL_TONE_MAPPING",[dp]:"CUSTOM_TONE_MAPPING"};var wF=new Float32Array(16),MF=new Float32Array(9),AF=new Float32Array(4);var TF={[cp]:"Linear",[hp]:"Reinhard",[up]:"Cineon",[fp]:"ACESFilmic",[pp]:"AgX",[mp]:"Neutral",[dp]:"Custom"};var EF={[fb]:"SHADOWMAP_TYPE_PCF",[db]:"SHADOWMAP_TYPE_VSM"};var CF={[xb]:"ENVMAP_MODE_REFRACTION"};var RF={[pb]:"ENVMAP_BLENDING_MULTIPLY",[mb]:"ENVMAP_BLENDING_MIX",[gb]:"ENVMAP_BLENDING_ADD"};var wP=new pe;wP.set(-1,0,0,0,1,0,0,0,1);var PF=new Uint16Array([12469,15057,12620,14925,13266,14620,13807,14376,14323,13990,14545,13625,14713,13328,14840,12882,14931,12528,14996,12233,15039,11829,15066,11525,15080,11295,15085,10976,15082,10705,15073,10495,13880,14564,13898,14542,13977,14430,14158,14124,14393,13732,14556,13410,14702,12996,14814,12596,14891,12291,14937,11834,14957,11489,14958,11194,14943,10803,14921,10506,14893,10278,14858,9960,14484,14039,14487,14025,14499,13941,14524,13740,14574,13468,14654,13106,14743,12678,14818,12344,14867,11893,14889,11509,14893,11180,14881,10751,14852,10428,14812,10128,14765,9754,14712,9466,14764,13480,14764,13475,14766,13440,14766,13347,14769,13070,14786,12713,14816,12387,14844,11957,14860,11549,14868,11215,14855,10751,14825,10403,14782,10044,14729,9651,14666,9352,14599,9029,14967,12835,14966,12831,14963,12804,14954,12723,14936,12564,14917,12347,14900,11958,14886,11569,14878,11247,14859,10765,14828,10401,14784,10011,14727,9600,14660,9289,14586,8893,14508,8533,15111,12234,15110,12234,15104,12216,15092,12156,15067,12010,15028,11776,14981,11500,14942,11205,14902,10752,14861,10393,14812,9991,14752,9570,14682,9252,14603,8808,14519,8445,14431,8145,15209,11449,15208,11451,15202,11451,15190,11438,15163,11384,15117,11274,15055,10979,14994,10648,14932,10343,14871,9936,14803,9532,14729,9218,14645,8742,14556,8381,14461,8020,14365,7603,15273,10603,15272,10607,15267,10619,15256,10631,15231,10614,15182,10535,15118,10389,15042,10167,14963,9787,14883,9447,14800,9115,14710,8665,14615,8318,14514,7911,14411,7507,14279,7198,15314,9675,15313,9683,15309,9712,15298,9759,15277,9797,15229,9773,15166,9668,15084,9487,14995,9274,14898,8910,14800,8539,14697,8234,14590,7790,14479,7409,14367,7067,14178,6621,15337,8619,15337,8631,15333,8677,15325,8769,15305,8871,15264,8940,15202,8909,15119,8775,15022,8565,14916,8328,14804,8009,14688,7614,14569,7287,14448,6888,14321,6483,14088,6171,15350,7402,15350,7419,15347,7480,15340,7613,15322,7804,15287,7973,15229,8057,15148,8012,15046,7846,14933,7611,14810,7357,14682,7069,14552,6656,14421,6316,14251,5948,14007,5528,15356,5942,15356,5977,15353,6119,15348,6294,15332,6551,15302,6824,15249,7044,15171,7122,15070,7050,14949,6861,14818,6611,14679,6349,14538,6067,14398,5651,14189,5311,13935,4958,15359,4123,15359,4153,15356,4296,15353,4646,15338,5160,15311,5508,15263,5829,15188,6042,15088,6094,14966,6001,14826,5796,14678,5543,14527,5287,14377,4985,14133,4586,13869,4257,15360,1563,15360,1642,15358,2076,15354,2636,15341,3350,15317,4019,15273,4429,15203,4732,15105,4911,14981,4932,14836,4818,14679,4621,14517,4386,14359,4156,14083,3795,13808,3437,15360,122,15360,137,15358,285,15355,636,15344,1274,15322,2177,15281,2765,15215,3223,15120,3451,14995,3569,14846,3567,14681,3466,14511,3305,14344,3121,14037,2800,13753,2467,15360,0,15360,1,15359,21,15355,89,15346,253,15325,479,15287,796,15225,1148,15133,1492,15008,1749,14856,1882,14685,1886,14506,1783,14324,1608,13996,1398,13702,1183]);function _p(s,e,t={}){return s.dataset.stage=e.name,s.dataset.controls=String(t.controls??!0),{element:s,scene:new ha}}var MP=["iso","top","front","right"],eh=class{constructor(e,t){this.studio=e;this.picked=t;this.arrows=new rc(re("views"),e),e.connection.on("scene",i=>this.take(i)),e.scene.watch(i=>i&&this.show(i)),e.link.watch(i=>this.viewer?.select(i)),e.against.watch(()=>this.ghost()),e.keptOne.watch(()=>this.ghost()),K(this.told,"The picture follows the figures.")}studio;picked;arrows;told=re("told");units=S("select",{ariaLabel:"Show one unit alone",change:()=>this.viewer?.isolate(this.units.value||null)});cut=S("select",{ariaLabel:"Section",change:()=>this.section()});depth=S("input",{type:"range",min:0,max:1,step:.005,value:"0.5",ariaLabel:"Place of the section",hidden:!0,input:()=>this.section()});toggles=new Map;isOld=!1;second=null;get viewer(){return this.studio.viewer.value}take(e){let t=this.studio.scene.value,i=e.data;this.studio.scene.set(e.whole||t===null?i:{...t,...i})}show(e){this.isOld=!1,this.viewer===null?this.begin(e):this.viewer.alive&&this.viewer.replace(e),this.second?.replace(e),this.offerUnits(e),this.ghost()}begin(e){let t=this.attempt(e);if(t===null||!t.alive)return this.without();K(this.told),this.studio.viewer.set(t),this.tools(),t.onPick(i=>this.picked(i)),t.select(this.studio.link.value)}attempt(e){try{return _p(re("view"),e,{controls:!1})}catch(t){return console.warn("the viewer does not start:",t),null}}without(){document.body.classList.add("flat"),K(this.told,"This browser gives no WebGL: the stage is not drawn. Numbers, figures, responses and the file work without it; links are chosen under Part.")}tools(){this.cut.append(new Option("no section",""),...["x","y","z"].map(e=>new Option(`cut ${e}`,e))),K(re("tools"),this.button("fit","Fit (F)",()=>this.fit()),...MP.map(e=>this.button(e,e,()=>this.viewer?.look(e))),this.toggle("platform","see through the platform (G)",e=>this.viewer?.ghostPlatform(e)),this.toggle("names","names (L)",e=>this.viewer?.showLabels(e)),this.units,this.cut,this.depth,this.toggle("old","the old design solid, the new one as its ghost (C)",e=>this.swap(e)))}button(e,t,i){return S("button",{type:"button",title:t,click:i},e)}toggle(e,t,i){let n=this.button(e,t,()=>{let r=n.getAttribute("aria-pressed")!=="true";n.setAttribute("aria-pressed",String(r)),i(r)});return n.setAttribute("aria-pressed","false"),this.toggles.set(e,n),n}press(e){this.toggles.get(e)?.click()}fit(){this.viewer?.fit(this.studio.link.value??void 0)}offerUnits(e){let t=[...new Set(e.parts.map(i=>i.unit).filter(i=>i!==void 0))];this.units.options.length!==t.length+1&&this.units.replaceChildren(new Option("all units",""),...t.map(i=>new Option(i)))}section(){let e=this.cut.value||null;this.depth.hidden=e===null,this.viewer?.section(e,Number(this.depth.value))}other(){let e=this.studio.kept.get(this.studio.against.value)?.scene??null;return e===this.studio.scene.value?null:e}ghost(){let{viewer:e}=this;if(!e?.alive)return;let t=this.other();e.showGhost(this.isOld?this.studio.scene.value:t);let i=this.toggles.get("old");i&&(i.disabled=t===null&&!this.isOld)}swap(e){let t=e?this.other():this.studio.scene.value;t&&(this.isOld=e,this.viewer?.replace(t),this.ghost(),re("stage").classList.toggle("shows-old",e))}beside(e){let t=re("second");t.hidden=!e;let i=this.studio.scene.value;return e&&!this.second&&i&&this.viewer?.alive&&(this.second=_p(t,i,{controls:!1})),e?this.second:null}};var th=class{constructor(e){this.connection=e;e.on("state",t=>this.state.set(t)),e.on("figures",t=>this.figures.set(t)),e.on("verdicts",t=>this.verdicts.set(t)),e.on("reach",t=>this.reach.set(t)),e.on("slopes",t=>this.slopes.set(t)),e.on("motion",t=>this.motion.set(t)),e.on("refusal",t=>this.tell(t.problems.map(i=>[i.where,i.what,i.advice].filter(Boolean).join(": ")).join(" "),!0)),this.figures.watch(()=>this.keepFile()),this.scene.watch(()=>this.keepFile())}connection;state=new rt(null);figures=new rt(null);verdicts=new rt(null);reach=new rt(null);slopes=new rt(null);motion=new rt(null);scene=new rt(null);link=new rt(null);mode=new rt(null);tab=new rt("figures");line=new rt({line:0,focus:!1});against=new rt("");notice=new rt({text:"",bad:!1});viewer=new rt(null);kept=new Map;keptOne=new rt(0);ask(e){return this.connection.ask(e)}tell(e,t=!1){e&&this.notice.set({text:e,bad:t})}isPresent(e){return e===this.state.value?.revision}goto(e,t=!0){e&&this.line.set({line:e,focus:t})}keep(e){this.kept.set(e,{scene:this.scene.value,figures:this.figures.value}),this.keptOne.set(this.keptOne.value+1)}keepFile(){let e=this.state.value;e&&e.saved&&e.sound&&this.keep("")}};var je=new th(new Ma);yv(je);bv();var Bs=new eh(je,EP),Mp=new mc(je),Cb=new tc(je,RP),Sp=new cc(je,Cb),AP=new oc(je,CP),wp=new pc(je,Bs),Rb=new fc(je,Bs),TP=new dc(je),Pb=_v(wp,Rb.root);new ic(je);new nc(je);new ac(je,Bs);new lc(je);new wa(je);new kc(je);function EP(s){let e=s?.part.name??null,t=e!==null&&e in(je.state.value?.links??{});je.link.set(t?e:null),s&&!t&&AP.other(s)}function CP(s){Cb.lighten(s.lines),Mp.reveal(s.addresses)}function RP(s){Mp.reveal(s.addresses);let[e]=s.links;e&&(je.viewer.value?.select(e),je.viewer.value?.setColours(s.links.length>1?Object.fromEntries(s.links.map(t=>[t,[.95,.6,.1]])):null))}function Qr(s,e){Pb("jog"),Rb.nudge(s,e)}function PP(s){Pb("modes"),je.mode.set(s||null)}var kb=[{keys:["mod+z"],shown:"Ctrl+Z",about:"undo",act:()=>{Sp.undo()},always:!0},{keys:["mod+shift+z","mod+y"],shown:"Ctrl+Shift+Z",about:"redo",act:()=>{Sp.redo()},always:!0},{keys:["mod+s"],shown:"Ctrl+S",about:"save",act:()=>{Sp.save()},always:!0},{keys:["/"],shown:"/",about:"find a number",act:()=>Mp.find()},{keys:["1","2","3","4","5","6","7","8","9","0"],shown:"1 … 9, 0",about:"play a mode; at rest",act:s=>PP(Number(s))},{keys:["space"],shown:"space",about:"play or hold",act:()=>wp.toggle()},{keys:["[","]"],shown:"[  ]",about:"smaller, larger amplitude",act:s=>wp.louder(s==="]"?1.25:.8)},{keys:["arrowright","arrowleft"],shown:"← →",about:"platform along x; with shift about y",act:s=>Qr("x",s==="arrowright"?1:-1)},{keys:["arrowup","arrowdown"],shown:"↑ ↓",about:"platform along y; with shift about x",act:s=>Qr("y",s==="arrowup"?1:-1)},{keys:["pageup","pagedown"],shown:"PgUp PgDn",about:"platform along z; with shift about z",act:s=>Qr("z",s==="pageup"?1:-1)},{keys:["shift+arrowright","shift+arrowleft"],shown:"",about:"",act:s=>Qr("ry",s.endsWith("right")?1:-1)},{keys:["shift+arrowup","shift+arrowdown"],shown:"",about:"",act:s=>Qr("rx",s.endsWith("up")?-1:1)},{keys:["shift+pageup","shift+pagedown"],shown:"",about:"",act:s=>Qr("rz",s.endsWith("up")?1:-1)},{keys:["f"],shown:"F",about:"fit the stage, or the selected part",act:()=>Bs.fit()},{keys:["g"],shown:"G",about:"see through the platform",act:()=>Bs.press("platform")},{keys:["l"],shown:"L",about:"names of parts",act:()=>Bs.press("names")},{keys:["c"],shown:"C",about:"old design and new: which is solid, which the ghost",act:()=>Bs.press("old")},{keys:["r"],shown:"R",about:"report",act:()=>TP.offer("analyse")},{keys:["escape"],shown:"Esc",about:"select nothing",act:()=>je.link.set(null)},{keys:["?"],shown:"?",about:"these keys",act:()=>id(kb)}];xv(kb);Object.assign(window,{studio:je});je.connection.open();})();
